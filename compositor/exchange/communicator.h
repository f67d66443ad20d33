// SPDX-License-Identifier: Apache-2.0
// How the ranks of a node group reach each other. The exchanges and the node loop use this interface and never
// call MPI: only mpi_communicator.cc does. thread_communicator.cc runs the ranks as threads of one process.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

namespace understudy::compositor {

using Rank = int;

/// The group is broken: another rank gave up or is gone.
class RankLost : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct Outgoing {
  Rank to = 0;
  std::span<const std::byte> bytes;
  /// The receiver has set Incoming::seen: it may read bytes that lie in a shared_segment() in place.
  bool may_be_seen = false;
};

struct Incoming {
  Rank from = 0;
  std::span<std::byte> bytes;  ///< exactly as many as the sender sends
  /// If set: the sender may send less, and this is how much it sent. Such messages have at most 1 GiB.
  std::size_t* received = nullptr;
  /// If set, with `received`: the message may stay where its sender made it, and this becomes that place.
  /// Otherwise the message is in `bytes`, and this is unchanged.
  std::span<const std::byte>* seen = nullptr;
};

/// A short message that no rank needs to wait for.
struct ControlMessage {
  Rank from = 0;
  std::vector<std::byte> bytes;
};
/// Few enough that MPI sends them without asking the receiver first.
constexpr std::size_t most_control_bytes = 4000;

/// All functions except rank(), size(), machines(), send_control() and take_control_message() may block until
/// the other ranks take part, and may throw RankLost.
class Communicator {
 public:
  virtual ~Communicator() = default;

  virtual Rank rank() const = 0;
  virtual int size() const = 0;

  /// Returns a number for the machine of each rank, by rank: ranks with the same number may open each other's
  /// /proc/PID/fd. Ranks that could not have numbers of their own.
  virtual std::vector<int> machines() const {
    std::vector<int> apart(static_cast<std::size_t>(size()));
    for (std::size_t rank = 0; rank < apart.size(); ++rank) apart[rank] = int(rank);
    return apart;
  }

  /// Sends and receives all of these messages at once, in any order; returns when all have arrived. At most one
  /// message from one rank to another per transfer. Ranks that neither send nor receive need not call it.
  virtual void transfer(std::span<const Outgoing> outgoing, std::span<const Incoming> incoming) = 0;

  /// Returns memory for a message that its receiver may read in place. It stays as it is until all ranks have
  /// met in gather_to_all(). Empty if ranks share no memory, or not enough.
  virtual std::span<std::byte> shared_segment(std::size_t /*bytes*/) { return {}; }

  /// Collective: every rank gets the bytes of `root`. The waiting ranks sleep, so that a group without work
  /// leaves the processor to the viewer.
  virtual void broadcast(Rank root, std::span<std::byte> bytes) = 0;

  /// Collective: collects `mine` of all ranks in `all`, size() times as many bytes, in rank order.
  virtual void gather_to_all(std::span<const std::byte> mine, std::span<std::byte> all) = 0;

  /// Sends a control message of at most most_control_bytes to another rank, without waiting.
  virtual void send_control(Rank to, std::span<const std::byte> control) = 0;
  /// Returns a control message that has arrived, if there is one; those of one sender come in their order.
  virtual std::optional<ControlMessage> take_control_message() = 0;
  virtual ControlMessage wait_for_control_message() = 0;

  /// Ends the whole group because this rank cannot go on; no rank is left waiting for it.
  [[noreturn]] virtual void abandon(const std::string& why) = 0;
};

/// The bytes of a plain value, for sending it between ranks of one build on machines of one kind.
template <class T>
requires std::is_trivially_copyable_v<T> std::span<std::byte> bytes_of(T& value) {
  return std::as_writable_bytes(std::span(&value, 1));
}

}  // namespace understudy::compositor
