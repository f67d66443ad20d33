// SPDX-License-Identifier: Apache-2.0
// Base of tests that run whole programs: a separate folder, the viewers' commands, the engine's CT, and a check
// of what is left behind.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <initializer_list>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <set>
#include <string>
#include <vector>

#include "tests/apps/viewer/run_viewer.h"
#include "tests/apps/viewer/temporary_folder.h"
#include "tests/clients/child.h"

namespace clients {

using Words = std::vector<std::string>;

Words operator+(Words first, const Words& second);

/// A requirement of a test.
enum class Need { engine, mpi, x_server, osgvolume, imagemagick, apitrace, piglit };

/// Names what this machine lacks and where it comes from, for GTEST_SKIP; empty if nothing is missing.
std::string missing(std::initializer_list<Need> needs);

/// The CT of an engine, 256 x 256 x 110 bytes.
std::filesystem::path engine_file();

const std::filesystem::path programs = PROGRAMS;
const std::filesystem::path libraries = LIBRARIES;
const std::filesystem::path system_libraries = SYSTEM_LIBRARIES;

/// `understudy run OPTIONS -- `, the prefix of a viewer's command.
Words under(const Words& options = {});

/// The bundled viewer on the engine, off screen, 256 x 256.
Words engine_viewer(const std::string& mode, const Words& options);

/// Difference of two images, printed after `what`.
viewer_test::Difference told(const std::string& what, const viewer_test::Image& a, const viewer_test::Image& b);

/// Number of runs of slices that the nodes drew, over all volumes of a report.
int substituted(const nlohmann::json& report);

class CommandTest : public testing::Test {
 protected:
  CommandTest();

  std::filesystem::path file(const std::string& name) const { return folder_.file(name); }

  /// With runtime files (sockets, folders of runs) in this test's folder.
  Command command_of(const Words& words, std::map<std::string, std::string> environment = {}) const;
  Outcome run(const Words& words, const std::map<std::string, std::string>& environment = {}) const;
  /// The same; expects status 0.
  Outcome run_well(const Words& words, const std::map<std::string, std::string>& environment = {}) const;

  nlohmann::json json(const std::string& name) const;
  viewer_test::Image png(const std::string& name) const { return viewer_test::read_png(file(name).string()); }

  /// Ids of living processes that were started from this test, whoever their parents are now, and whose program
  /// is called `program` (empty: any).
  std::vector<pid_t> processes(const std::string& program = "") const;

  /// Waits for processes that are ending. Then lists processes, sockets, folders and shared memory that are
  /// left of the programs that were run; empty if there are none.
  std::string leftovers() const;

  viewer_test::TemporaryFolder folder_;
  std::filesystem::path runtime_;
  /// Leftovers of other programs that were killed earlier; they do not count for this test.
  std::set<std::string> abandoned_before_;
};

}  // namespace clients
