// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/message_counter.h"

#include <mpi.h>

#include <utility>

namespace understudy::bench {

namespace {

Sent& sent() {
  static Sent so_far;
  return so_far;
}

void count_message(int count, MPI_Datatype type, int times = 1) {
  int size = 0;
  PMPI_Type_size(type, &size);
  sent().messages += std::uint64_t(times);
  sent().bytes += std::uint64_t(times) * std::uint64_t(count) * std::uint64_t(size);
}

int others(MPI_Comm group) {
  int size = 0;
  PMPI_Comm_size(group, &size);
  return size - 1;
}

bool is_root(int root, MPI_Comm group) {
  int rank = 0;
  PMPI_Comm_rank(group, &rank);
  return rank == root;
}

}  // namespace

Sent take_sent() {
  return std::exchange(sent(), {});
}

}  // namespace understudy::bench

// MPI's profiling interface: these functions take precedence over the library's own, which
// remain available as PMPI_*.
using understudy::bench::count_message;
using understudy::bench::is_root;
using understudy::bench::others;

extern "C" {

int MPI_Send(const void* buffer, int count, MPI_Datatype type, int to, int tag, MPI_Comm group) {
  count_message(count, type);
  return PMPI_Send(buffer, count, type, to, tag, group);
}

int MPI_Isend(const void* buffer, int count, MPI_Datatype type, int to, int tag, MPI_Comm group,
              MPI_Request* request) {
  count_message(count, type);
  return PMPI_Isend(buffer, count, type, to, tag, group, request);
}

int MPI_Sendrecv(const void* buffer, int count, MPI_Datatype type, int to, int tag, void* room, int room_count,
                 MPI_Datatype room_type, int from, int room_tag, MPI_Comm group, MPI_Status* status) {
  count_message(count, type);
  return PMPI_Sendrecv(buffer, count, type, to, tag, room, room_count, room_type, from, room_tag, group,
                       status);
}

int MPI_Gather(const void* buffer, int count, MPI_Datatype type, void* room, int room_count,
               MPI_Datatype room_type, int root, MPI_Comm group) {
  if (!is_root(root, group)) count_message(count, type);
  return PMPI_Gather(buffer, count, type, room, room_count, room_type, root, group);
}

int MPI_Gatherv(const void* buffer, int count, MPI_Datatype type, void* room, const int counts[],
                const int places[], MPI_Datatype room_type, int root, MPI_Comm group) {
  if (!is_root(root, group)) count_message(count, type);
  return PMPI_Gatherv(buffer, count, type, room, counts, places, room_type, root, group);
}

int MPI_Allgather(const void* buffer, int count, MPI_Datatype type, void* room, int room_count,
                  MPI_Datatype room_type, MPI_Comm group) {
  count_message(count, type, others(group));
  return PMPI_Allgather(buffer, count, type, room, room_count, room_type, group);
}

int MPI_Iallgather(const void* buffer, int count, MPI_Datatype type, void* room, int room_count,
                   MPI_Datatype room_type, MPI_Comm group, MPI_Request* request) {
  count_message(count, type, others(group));
  return PMPI_Iallgather(buffer, count, type, room, room_count, room_type, group, request);
}

int MPI_Alltoall(const void* buffer, int count, MPI_Datatype type, void* room, int room_count,
                 MPI_Datatype room_type, MPI_Comm group) {
  count_message(count, type, others(group));
  return PMPI_Alltoall(buffer, count, type, room, room_count, room_type, group);
}
}
