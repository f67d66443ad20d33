// SPDX-License-Identifier: Apache-2.0
#include "compositor/exchange/mpi_communicator.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <malloc.h>
#include <mpi.h>
#include <sched.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <system_error>
#include <thread>
#include <vector>

#include "compositor/logging/log.h"

namespace understudy::compositor {

namespace {

using Clock = std::chrono::steady_clock;

// MPI counts in int.
constexpr std::size_t max_bytes_per_message = std::size_t(1) << 30;
constexpr int image_tag = 1;
constexpr int control_tag = 2;
constexpr int collective_tag = 3;
constexpr int place_tag = 4;

constexpr auto patience = std::chrono::microseconds(100);

template <class Span, class Call>
void in_pieces(Span bytes, Call call) {
  for (std::size_t from = 0; from < bytes.size(); from += max_bytes_per_message)
    call(bytes.subspan(from, std::min(max_bytes_per_message, bytes.size() - from)));
}

// Checks the file before it opens it: in another container the same number is another process, whose files must
// not be opened.
FileDescriptor opened_if_same(const std::array<std::int64_t, 4>& where) {
  const auto [process, number, device, file] = where;
  if (number < 0) return {};
  const FileDescriptor found(
      ::open(fmt::format("/proc/{}/fd/{}", process, number).c_str(), O_PATH | O_CLOEXEC));
  struct stat status {};
  if (!found || ::fstat(found.get(), &status) != 0 || std::int64_t(status.st_dev) != device ||
      std::int64_t(status.st_ino) != file)
    return {};
  return FileDescriptor(::open(fmt::format("/proc/self/fd/{}", found.get()).c_str(), O_RDWR | O_CLOEXEC));
}

// Returns what every rank of this machine has made for the others, by rank; empty, on all of them, if one has
// made nothing or cannot open another's.
std::vector<FileDescriptor> shared_by_all(MPI_Comm machine, Rank mine, FileDescriptor made) {
  int ranks = 0;
  MPI_Comm_size(machine, &ranks);
  using Where = std::array<std::int64_t, 4>;  // process, descriptor, device, file
  struct stat status {};
  const bool known = made && ::fstat(made.get(), &status) == 0;
  const Where here{::getpid(), known ? made.get() : -1, std::int64_t(status.st_dev),
                   std::int64_t(status.st_ino)};
  std::vector<Where> all(static_cast<std::size_t>(ranks));
  MPI_Allgather(here.data(), 4, MPI_INT64_T, all.data(), 4, MPI_INT64_T, machine);
  std::vector<FileDescriptor> opened;
  opened.reserve(all.size());
  for (Rank rank = 0; rank < ranks; ++rank)
    opened.push_back(rank == mine ? FileDescriptor() : opened_if_same(all[std::size_t(rank)]));
  opened[std::size_t(mine)] = std::move(made);
  int complete = std::ranges::count_if(opened, &FileDescriptor::operator bool) == ranks ? 1 : 0;
  MPI_Allreduce(MPI_IN_PLACE, &complete, 1, MPI_INT, MPI_MIN, machine);
  if (complete == 0) opened.clear();
  return opened;
}

// Returns null if the system refuses.
template <class Make>
auto made_or_nothing(Make make) -> decltype(make()) {
  try {
    return make();
  } catch (const std::system_error&) {
    return {};
  }
}

// Returns what this rank has made, if all ranks have made theirs; otherwise null.
template <class Made>
Made if_all_have(MPI_Comm machine, Made made) {
  int all_have = made ? 1 : 0;
  MPI_Allreduce(MPI_IN_PLACE, &all_have, 1, MPI_INT, MPI_MIN, machine);
  return all_have != 0 ? std::move(made) : Made();
}

// OpenMPI polls while it waits. A rank that waits for long must leave the processor to the viewer and to the
// ranks that still work: first it only yields, then it sleeps until it is notified. If nobody notifies, it
// sleeps for a sixteenth of the time waited so far (so the wait grows by a sixteenth at most), at most a
// millisecond.
struct Wait {
  std::chrono::microseconds only_yield = patience;
  bool all_notify = false;  ///< those that are waited for notify this rank when they are done
};

template <class Done>
void wait_until(WakeUp* wake_ups, Done done, const Wait& wait) {
  constexpr auto longest_nap = std::chrono::microseconds(1000);
  // Should a notification ever be missed, the wait at most doubles.
  constexpr auto shortest_sleep = std::chrono::microseconds(1000);
  constexpr auto longest_sleep = std::chrono::microseconds(100'000);
  const auto start = Clock::now();
  for (;;) {
    const std::uint32_t notified = wake_ups ? wake_ups->notified() : 0;
    // OpenMPI checks for completion first, and then for arrivals: the second call sees what they complete.
    if (done() || done()) return;
    const auto waited = std::chrono::duration_cast<std::chrono::microseconds>(Clock::now() - start);
    const auto nap = std::min<std::chrono::microseconds>(waited / 16, longest_nap);
    if (waited < wait.only_yield)
      sched_yield();
    else if (wake_ups)
      wake_ups->sleep(notified, wait.all_notify ? std::clamp(waited, shortest_sleep, longest_sleep) : nap);
    else
      std::this_thread::sleep_for(nap);
  }
}

void complete(WakeUp* wake_ups, std::vector<MPI_Request>& requests, const Wait& wait,
              MPI_Status* statuses = MPI_STATUSES_IGNORE) {
  wait_until(
      wake_ups,
      [&] {
        int done = 0;
        MPI_Testall(int(requests.size()), requests.data(), &done, statuses);
        return done != 0;
      },
      wait);
}

}  // namespace

void MpiCommunicator::notify(Rank rank) {
  if (wake_up_) wake_up_->notify(rank);
}

struct MpiCommunicator::SentControl {
  std::vector<std::byte> bytes;
  MPI_Request request = MPI_REQUEST_NULL;
};

MpiCommunicator::MpiCommunicator(int& argc, char**& argv) {
  // Memory of an image's size is needed again for the next image. By default glibc returns it to the system;
  // every page would then be mapped and cleared anew, which takes longer than blending its content.
  mallopt(M_MMAP_THRESHOLD, 32 << 20);  // the most that glibc allows
  mallopt(M_TRIM_THRESHOLD, 256 << 20);
  int provided = 0;
  // Other threads of a rank cast rays. One thread at a time calls MPI: the main one, except for images that are
  // composited while they are drawn.
  MPI_Init_thread(&argc, &argv, MPI_THREAD_SERIALIZED, &provided);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  MPI_Comm_size(MPI_COMM_WORLD, &size_);
  meet_machine();
}

void MpiCommunicator::meet_machine() {
  MPI_Comm machine = MPI_COMM_NULL;
  MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine);
  MPI_Comm_size(machine, &local_size_);
  if (size_ > 1 && local_size_ == size_) {
    // Ranks have the same order on the machine as in the job.
    const std::vector<FileDescriptor> wake_ups =
        shared_by_all(machine, rank_, made_or_nothing([&] { return WakeUp::make_memory(size_); }));
    if (!wake_ups.empty())
      wake_up_ = if_all_have(
          machine, made_or_nothing([&] { return std::make_unique<WakeUp>(wake_ups.front(), size_, rank_); }));
    const std::vector<FileDescriptor> segments =
        shared_by_all(machine, rank_, made_or_nothing(SharedSegments::make_memory));
    if (!segments.empty())
      segments_ = if_all_have(
          machine, made_or_nothing([&] { return std::make_unique<SharedSegments>(segments, rank_); }));
  }
  // Tests whether ranks that share a machine can open each other's descriptors.
  int local_rank = 0;
  MPI_Comm_rank(machine, &local_rank);
  const bool can_open =
      !shared_by_all(machine, local_rank, made_or_nothing(SharedSegments::make_memory)).empty();
  int mine = rank_;
  if (can_open) MPI_Allreduce(MPI_IN_PLACE, &mine, 1, MPI_INT, MPI_MIN, machine);
  machines_.resize(std::size_t(size_));
  MPI_Allgather(&mine, 1, MPI_INT, machines_.data(), 1, MPI_INT, MPI_COMM_WORLD);
  MPI_Comm_free(&machine);
}

MpiCommunicator::~MpiCommunicator() {
  MPI_Finalize();
}

std::span<std::byte> MpiCommunicator::shared_segment(std::size_t bytes) {
  return segments_ ? segments_->segment(bytes) : std::span<std::byte>();
}

void MpiCommunicator::transfer(std::span<const Outgoing> outgoing, std::span<const Incoming> incoming) {
  if (!segments_) return move(outgoing, incoming);
  // A sender that may leave a message in place tells where it is, or that it sends the message after all.
  constexpr SharedSegments::Place nowhere{~std::uint64_t(0), 0};
  std::vector<MPI_Request> requests;
  std::vector<SharedSegments::Place> heard(incoming.size()), told(outgoing.size());
  for (std::size_t i = 0; i < incoming.size(); ++i)
    if (incoming[i].seen != nullptr)
      MPI_Irecv(&heard[i], sizeof heard[i], MPI_BYTE, incoming[i].from, place_tag, MPI_COMM_WORLD,
                &requests.emplace_back());
  std::vector<Outgoing> moving;
  for (std::size_t i = 0; i < outgoing.size(); ++i) {
    const Outgoing& message = outgoing[i];
    told[i] = nowhere;
    if (message.may_be_seen) {
      told[i] = segments_->place_of(message.bytes).value_or(nowhere);
      MPI_Isend(&told[i], sizeof told[i], MPI_BYTE, message.to, place_tag, MPI_COMM_WORLD,
                &requests.emplace_back());
      notify(message.to);
    }
    if (told[i].first == nowhere.first) moving.push_back(message);
  }
  complete(wake_up_.get(), requests, {patience, true});
  for (const Outgoing& message : outgoing)
    if (message.may_be_seen) notify(message.to);
  std::vector<Incoming> coming;
  for (std::size_t i = 0; i < incoming.size(); ++i) {
    if (incoming[i].seen == nullptr || heard[i].first == nowhere.first) {
      coming.push_back(incoming[i]);
      continue;
    }
    *incoming[i].seen = segments_->at(incoming[i].from, heard[i]);
    *incoming[i].received = incoming[i].seen->size();
  }
  if (!moving.empty() || !coming.empty()) move(moving, coming);
}

void MpiCommunicator::move(std::span<const Outgoing> outgoing, std::span<const Incoming> incoming) {
  std::vector<MPI_Request> requests;
  std::vector<std::size_t> first;  // index of each incoming message's first request
  for (const Incoming& message : incoming) {
    first.push_back(requests.size());
    in_pieces(message.bytes, [&](std::span<std::byte> piece) {
      MPI_Irecv(piece.data(), int(piece.size()), MPI_BYTE, message.from, image_tag, MPI_COMM_WORLD,
                &requests.emplace_back());
    });
  }
  for (const Outgoing& message : outgoing)
    in_pieces(message.bytes, [&](std::span<const std::byte> piece) {
      MPI_Isend(piece.data(), int(piece.size()), MPI_BYTE, message.to, image_tag, MPI_COMM_WORLD,
                &requests.emplace_back());
    });
  for (const Outgoing& message : outgoing) notify(message.to);
  std::vector<MPI_Status> statuses(requests.size());
  // Long messages move in pieces that both sides must request: a rank that sleeps in between delays the other.
  // So ranks stay awake for as long as a slow machine takes to copy that much.
  std::size_t bytes = 0;
  for (const Outgoing& message : outgoing) bytes += message.bytes.size();
  for (const Incoming& message : incoming) bytes += message.bytes.size();
  constexpr std::size_t bytes_per_microsecond = 500;
  complete(wake_up_.get(), requests, {patience + std::chrono::microseconds(bytes / bytes_per_microsecond)},
           statuses.data());
  for (std::size_t i = 0; i < incoming.size(); ++i) {
    if (incoming[i].received == nullptr) continue;
    *incoming[i].received = incoming[i].bytes.size();
    if (incoming[i].bytes.empty() || incoming[i].bytes.size() > max_bytes_per_message) continue;
    int received = 0;
    MPI_Get_count(&statuses[first[i]], MPI_BYTE, &received);
    *incoming[i].received = std::size_t(received);
  }
}

// If ranks wake each other, one message from a rank to each of the others arrives sooner than MPI's broadcast,
// which passes from rank to rank, each of which must wake first.
void MpiCommunicator::tell_others(Rank from, std::span<std::byte> bytes) {
  const Wait wait{patience, bytes.size() <= most_control_bytes};
  in_pieces(bytes, [&](std::span<std::byte> piece) {
    std::vector<MPI_Request> requests;
    if (rank_ != from) {
      MPI_Irecv(piece.data(), int(piece.size()), MPI_BYTE, from, collective_tag, MPI_COMM_WORLD,
                &requests.emplace_back());
      return complete(wake_up_.get(), requests, wait);
    }
    const auto notify_all = [&] {
      for (Rank rank = 0; rank < size_; ++rank)
        if (rank != rank_) notify(rank);
    };
    for (Rank rank = 0; rank < size_; ++rank)
      if (rank != rank_)
        MPI_Isend(piece.data(), int(piece.size()), MPI_BYTE, rank, collective_tag, MPI_COMM_WORLD,
                  &requests.emplace_back());
    notify_all();
    complete(wake_up_.get(), requests, {});
    notify_all();  // a message may have waited for space until now
  });
}

void MpiCommunicator::broadcast(Rank root, std::span<std::byte> bytes) {
  if (wake_up_) return tell_others(root, bytes);
  in_pieces(bytes, [&](std::span<std::byte> piece) {
    std::vector<MPI_Request> request(1);
    MPI_Ibcast(piece.data(), int(piece.size()), MPI_BYTE, root, MPI_COMM_WORLD, request.data());
    complete(wake_up_.get(), request, {});
  });
}

void MpiCommunicator::gather_to_all(std::span<const std::byte> mine, std::span<std::byte> all) {
  std::vector<MPI_Request> requests;
  if (!wake_up_) {
    MPI_Iallgather(mine.data(), int(mine.size()), MPI_BYTE, all.data(), int(mine.size()), MPI_BYTE,
                   MPI_COMM_WORLD, &requests.emplace_back());
    complete(wake_up_.get(), requests, {});
    if (segments_) segments_->clear();
    return;
  }
  if (rank_ == 0) {
    std::ranges::copy(mine, all.begin());
    for (Rank rank = 1; rank < size_; ++rank)
      MPI_Irecv(all.data() + std::size_t(rank) * mine.size(), int(mine.size()), MPI_BYTE, rank, collective_tag,
                MPI_COMM_WORLD, &requests.emplace_back());
    complete(wake_up_.get(), requests, {patience, mine.size() <= most_control_bytes});
  } else {
    MPI_Isend(mine.data(), int(mine.size()), MPI_BYTE, 0, collective_tag, MPI_COMM_WORLD,
              &requests.emplace_back());
    notify(0);
    complete(wake_up_.get(), requests, {});
    notify(0);
  }
  tell_others(0, all);
  // All ranks have come here, so none reads earlier messages any more.
  if (segments_) segments_->clear();
}

void MpiCommunicator::forget_sent() {
  std::erase_if(sent_controls_, [](SentControl& control) {
    int gone = 0;
    MPI_Test(&control.request, &gone, MPI_STATUS_IGNORE);
    return gone != 0;
  });
}

void MpiCommunicator::send_control(Rank to, std::span<const std::byte> control) {
  forget_sent();
  SentControl& sent = sent_controls_.emplace_back();
  sent.bytes.assign(control.begin(), control.end());
  MPI_Isend(sent.bytes.data(), int(sent.bytes.size()), MPI_BYTE, to, control_tag, MPI_COMM_WORLD,
            &sent.request);
  notify(to);  // NOLINT(clang-analyzer-optin.mpi.MPI-Checker): forget_sent() completes it
}

std::optional<ControlMessage> MpiCommunicator::take_control_message() {
  int has_come = 0;
  MPI_Message message = MPI_MESSAGE_NULL;
  MPI_Status status;
  MPI_Improbe(MPI_ANY_SOURCE, control_tag, MPI_COMM_WORLD, &has_come, &message, &status);
  if (has_come == 0) return std::nullopt;
  int bytes = 0;
  MPI_Get_count(&status, MPI_BYTE, &bytes);
  ControlMessage control{status.MPI_SOURCE, std::vector<std::byte>(std::size_t(bytes))};
  MPI_Mrecv(control.bytes.data(), bytes, MPI_BYTE, &message, MPI_STATUS_IGNORE);
  return control;
}

ControlMessage MpiCommunicator::wait_for_control_message() {
  std::optional<ControlMessage> control;
  wait_until(wake_up_.get(), [&] { return (control = take_control_message()).has_value(); }, {});
  return std::move(*control);
}

void MpiCommunicator::abandon(const std::string& why) {
  logging::log(logging::Level::error, "rank {} ends the group: {}", rank_, why);
  MPI_Abort(MPI_COMM_WORLD, 1);
  std::abort();
}

}  // namespace understudy::compositor
