#include "compositor/exchange/mpi_link.h"

#include <malloc.h>
#include <mpi.h>
#include <sched.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <thread>
#include <vector>

namespace understudy::compositor {

namespace {

using Clock = std::chrono::steady_clock;

// MPI counts in int.
constexpr std::size_t max_bytes_per_message = std::size_t(1) << 30;
constexpr int picture_tag = 1;
constexpr int note_tag = 2;

constexpr auto patience = std::chrono::microseconds(100);

// OpenMPI polls while it waits. A rank that waits for long must leave the processor to the viewer and to the
// ranks that still work: first it only yields, then it sleeps for a sixteenth of the time it has waited so far
// (so the wait grows by a sixteenth at most), a millisecond at most.
template <class Done>
void wait_until(Done done, std::chrono::microseconds only_yield = patience) {
  constexpr auto longest_sleep = std::chrono::microseconds(1000);
  const auto start = Clock::now();
  while (!done()) {
    const auto waited = std::chrono::duration_cast<std::chrono::microseconds>(Clock::now() - start);
    if (waited < only_yield)
      sched_yield();
    else
      std::this_thread::sleep_for(std::min<std::chrono::microseconds>(waited / 16, longest_sleep));
  }
}

void complete(std::vector<MPI_Request>& requests, MPI_Status* statuses = MPI_STATUSES_IGNORE,
              std::chrono::microseconds only_yield = patience) {
  wait_until(
      [&] {
        int done = 0;
        MPI_Testall(int(requests.size()), requests.data(), &done, statuses);
        return done != 0;
      },
      only_yield);
}

template <class Span, class Call>
void in_pieces(Span bytes, Call call) {
  for (std::size_t from = 0; from < bytes.size(); from += max_bytes_per_message)
    call(bytes.subspan(from, std::min(max_bytes_per_message, bytes.size() - from)));
}

}  // namespace

struct MpiLink::Posted {
  std::vector<std::byte> bytes;
  MPI_Request request = MPI_REQUEST_NULL;
};

MpiLink::MpiLink(int& argc, char**& argv) {
  // Memory of a picture's size is needed again for the next one. Handed back to the system, as glibc does by
  // itself, every page of it would be fetched and cleared anew, which takes longer than blending what it holds.
  mallopt(M_MMAP_THRESHOLD, 32 << 20);  // the most that glibc allows
  mallopt(M_TRIM_THRESHOLD, 256 << 20);
  int provided = 0;
  // Other threads of a rank ray-cast; one at a time talks, the main one but for pictures that are composited
  // while they are drawn.
  MPI_Init_thread(&argc, &argv, MPI_THREAD_SERIALIZED, &provided);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  MPI_Comm_size(MPI_COMM_WORLD, &size_);
  MPI_Comm machine = MPI_COMM_NULL;
  MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine);
  MPI_Comm_size(machine, &local_size_);
  MPI_Comm_free(&machine);
}

MpiLink::~MpiLink() {
  MPI_Finalize();
}

void MpiLink::transfer(std::span<const Outgoing> outgoing, std::span<const Incoming> incoming) {
  std::vector<MPI_Request> requests;
  std::vector<std::size_t> first;  // request of each incoming message
  for (const Incoming& message : incoming) {
    first.push_back(requests.size());
    in_pieces(message.bytes, [&](std::span<std::byte> piece) {
      MPI_Irecv(piece.data(), int(piece.size()), MPI_BYTE, message.from, picture_tag, MPI_COMM_WORLD,
                &requests.emplace_back());
    });
  }
  for (const Outgoing& message : outgoing)
    in_pieces(message.bytes, [&](std::span<const std::byte> piece) {
      MPI_Isend(piece.data(), int(piece.size()), MPI_BYTE, message.to, picture_tag, MPI_COMM_WORLD,
                &requests.emplace_back());
    });
  std::vector<MPI_Status> statuses(requests.size());
  // Long messages move in pieces that both sides must ask for: who sleeps in between holds the other up. So
  // ranks stay awake for as long as a slow machine takes to copy that much.
  std::size_t bytes = 0;
  for (const Outgoing& message : outgoing) bytes += message.bytes.size();
  for (const Incoming& message : incoming) bytes += message.bytes.size();
  constexpr std::size_t bytes_per_microsecond = 500;
  complete(requests, statuses.data(), patience + std::chrono::microseconds(bytes / bytes_per_microsecond));
  for (std::size_t i = 0; i < incoming.size(); ++i) {
    if (incoming[i].received == nullptr) continue;
    *incoming[i].received = incoming[i].bytes.size();
    if (incoming[i].bytes.empty() || incoming[i].bytes.size() > max_bytes_per_message) continue;
    int received = 0;
    MPI_Get_count(&statuses[first[i]], MPI_BYTE, &received);
    *incoming[i].received = std::size_t(received);
  }
}

void MpiLink::broadcast(Rank root, std::span<std::byte> bytes) {
  in_pieces(bytes, [&](std::span<std::byte> piece) {
    std::vector<MPI_Request> request(1);
    MPI_Ibcast(piece.data(), int(piece.size()), MPI_BYTE, root, MPI_COMM_WORLD, request.data());
    complete(request);
  });
}

void MpiLink::gather_to_all(std::span<const std::byte> mine, std::span<std::byte> all) {
  std::vector<MPI_Request> request(1);
  MPI_Iallgather(mine.data(), int(mine.size()), MPI_BYTE, all.data(), int(mine.size()), MPI_BYTE,
                 MPI_COMM_WORLD, request.data());
  complete(request);
}

void MpiLink::forget_posted() {
  std::erase_if(posted_, [](Posted& note) {
    int gone = 0;
    MPI_Test(&note.request, &gone, MPI_STATUS_IGNORE);
    return gone != 0;
  });
}

void MpiLink::post(Rank to, std::span<const std::byte> note) {
  forget_posted();
  Posted& posted = posted_.emplace_back();
  posted.bytes.assign(note.begin(), note.end());
  MPI_Isend(posted.bytes.data(), int(posted.bytes.size()), MPI_BYTE, to, note_tag, MPI_COMM_WORLD,
            &posted.request);
}  // NOLINT(clang-analyzer-optin.mpi.MPI-Checker): forget_posted() sees to its end

std::optional<Note> MpiLink::take_note() {
  int has_come = 0;
  MPI_Message message = MPI_MESSAGE_NULL;
  MPI_Status status;
  MPI_Improbe(MPI_ANY_SOURCE, note_tag, MPI_COMM_WORLD, &has_come, &message, &status);
  if (has_come == 0) return std::nullopt;
  int bytes = 0;
  MPI_Get_count(&status, MPI_BYTE, &bytes);
  Note note{status.MPI_SOURCE, std::vector<std::byte>(std::size_t(bytes))};
  MPI_Mrecv(note.bytes.data(), bytes, MPI_BYTE, &message, MPI_STATUS_IGNORE);
  return note;
}

Note MpiLink::wait_for_note() {
  std::optional<Note> note;
  wait_until([&] { return (note = take_note()).has_value(); });
  return std::move(*note);
}

void MpiLink::abandon(const std::string& why) {
  std::fprintf(stderr, "understudy-node: rank %d ends the group: %s\n", rank_, why.c_str());
  MPI_Abort(MPI_COMM_WORLD, 1);
  std::abort();
}

}  // namespace understudy::compositor
