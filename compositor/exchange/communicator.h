// SPDX-License-Identifier: Apache-2.0
// How the ranks of a node group reach each other. The exchanges and the node loop are written against this
// interface and never say MPI; mpi_communicator.cc alone does, and thread_communicator.cc lets threads of one
// process play the ranks.
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

/// The group is broken: another rank gave up, or went away.
class RankLost : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct Outgoing {
  Rank to = 0;
  std::span<const std::byte> bytes;
  /// The receiver says so too (Incoming::seen): bytes that lie in a shared_segment() may be read there.
  bool may_be_seen = false;
};

struct Incoming {
  Rank from = 0;
  std::span<std::byte> bytes;  ///< exactly as many as the sender sends
  /// Set: the sender may send less, and this is how much it was. Such messages have at most 1 GiB.
  std::size_t* received = nullptr;
  /// Set, with `received`: the message may stay where its sender has made it, and this is where; else `bytes`.
  std::span<const std::byte>* seen = nullptr;
};

/// A message that nobody waits for.
struct ControlMessage {
  Rank from = 0;
  std::vector<std::byte> bytes;
};
/// So few that MPI sends them without asking the receiver first.
constexpr std::size_t most_control_bytes = 4000;

/// All functions but rank(), size(), machines(), send_control() and take_control_message() may block until the
/// other ranks take part, and throw RankLost.
class Communicator {
 public:
  virtual ~Communicator() = default;

  virtual Rank rank() const = 0;
  virtual int size() const = 0;

  /// By rank, the machine that it is on, as any number: ranks with the same one may open each other's
  /// /proc/PID/fd. Where they could not, each has a number of its own.
  virtual std::vector<int> machines() const {
    std::vector<int> apart(static_cast<std::size_t>(size()));
    for (std::size_t rank = 0; rank < apart.size(); ++rank) apart[rank] = int(rank);
    return apart;
  }

  /// Sends and receives all of these at once, in any order; returns when all have arrived. At most one message
  /// from one rank to another per transfer. Ranks that neither send nor receive need not call it.
  virtual void transfer(std::span<const Outgoing> outgoing, std::span<const Incoming> incoming) = 0;

  /// Memory for a message that its receiver may read in place. It stays as it is until all ranks have met in
  /// gather_to_all(). Empty where ranks share no memory, or not so much.
  virtual std::span<std::byte> shared_segment(std::size_t /*bytes*/) { return {}; }

  /// Collective: everybody leaves with the bytes of `root`. The waiting ranks sleep, so that a group without
  /// work leaves the processor to the viewer.
  virtual void broadcast(Rank root, std::span<std::byte> bytes) = 0;

  /// Collective: `all` holds size() times as many bytes as `mine`, in rank order.
  virtual void gather_to_all(std::span<const std::byte> mine, std::span<std::byte> all) = 0;

  /// Sends a control message of at most most_control_bytes to another rank, without waiting for anybody.
  virtual void send_control(Rank to, std::span<const std::byte> control) = 0;
  /// A control message that has come here; those of one sender in their order.
  virtual std::optional<ControlMessage> take_control_message() = 0;
  virtual ControlMessage wait_for_control_message() = 0;

  /// Ends the whole group because this rank cannot go on: no rank is left waiting for it.
  [[noreturn]] virtual void abandon(const std::string& why) = 0;
};

/// The bytes of a plain value, to send it between ranks of one build on machines of one kind.
template <class T>
requires std::is_trivially_copyable_v<T> std::span<std::byte> bytes_of(T& value) {
  return std::as_writable_bytes(std::span(&value, 1));
}

}  // namespace understudy::compositor
