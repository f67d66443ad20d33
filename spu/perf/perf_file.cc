// SPDX-License-Identifier: Apache-2.0
#include "spu/perf/perf_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <memory>

#include "compositor/logging/log.h"
#include "spu/report/report.h"

namespace understudy::spu {

Figures& PerfFile::begin_context() {
  const std::scoped_lock lock(mutex_);
  return contexts_.emplace_back();
}

void PerfFile::end_context(const Figures& figures) {
  const std::scoped_lock lock(mutex_);
  ended_.add(figures);
  contexts_.remove_if([&](const Figures& context) { return &context == &figures; });
  if (contexts_.empty() || !name_.empty()) write_locked();
}

void PerfFile::write_when_due() {
  if (name_.empty()) return;
  const std::unique_lock lock(mutex_, std::try_to_lock);
  // Another thread that holds the lock is writing.
  if (!lock || std::chrono::steady_clock::now() < due_) return;
  write_locked();
}

void PerfFile::write() {
  const std::scoped_lock lock(mutex_);
  write_locked();
}

void PerfFile::write_locked() {
  due_ = std::chrono::steady_clock::now() + std::chrono::milliseconds(500);
  const auto sum = std::make_unique<Figures>();
  sum->add(ended_);
  for (const Figures& context : contexts_) sum->add(context);
  const std::uint64_t calls = sum->total().calls.get();
  if (calls == calls_told_) return;
  calls_told_ = calls;
  if (name_.empty()) {
    std::fputs(figures_text(*sum).c_str(), stderr);
    return;
  }
  try {
    replace_file(name_, name_.ends_with(".json") ? figures_json(*sum) : figures_text(*sum));
  } catch (const std::exception& error) {
    if (!failure_told_) logging::log(logging::Level::warn, "perf: {}; name another file", error.what());
    failure_told_ = true;
  }
}

}  // namespace understudy::spu
