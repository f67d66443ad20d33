// The ranks of an MPI job. The source of this header is the one file that says MPI.
#pragma once

#include <list>
#include <memory>

#include "compositor/exchange/bells.h"
#include "compositor/exchange/link.h"
#include "compositor/exchange/shared_rooms.h"

namespace understudy::compositor {

class MpiLink : public Link {
 public:
  /// Starts MPI; one object per process, made on its main thread and used by one thread at a time.
  /// Where all ranks are on one machine, they wake each other and read messages in place.
  MpiLink(int& argc, char**& argv);
  ~MpiLink() override;
  MpiLink(const MpiLink&) = delete;
  MpiLink& operator=(const MpiLink&) = delete;

  Rank rank() const override { return rank_; }
  int size() const override { return size_; }
  /// Ranks of this job that share this machine's processors.
  int ranks_on_this_machine() const { return local_size_; }

  std::span<std::byte> shared_room(std::size_t bytes) override;
  void transfer(std::span<const Outgoing> outgoing, std::span<const Incoming> incoming) override;
  void broadcast(Rank root, std::span<std::byte> bytes) override;
  void gather_to_all(std::span<const std::byte> mine, std::span<std::byte> all) override;
  void post(Rank to, std::span<const std::byte> note) override;
  std::optional<Note> take_note() override;
  Note wait_for_note() override;
  [[noreturn]] void abandon(const std::string& why) override;

 private:
  struct Posted;
  void meet_machine();
  void move(std::span<const Outgoing> outgoing, std::span<const Incoming> incoming);
  void ring(Rank rank);
  void tell_others(Rank from, std::span<std::byte> bytes);
  void forget_posted();

  std::unique_ptr<Bells> bells_;        // where all ranks are on one machine
  std::unique_ptr<SharedRooms> rooms_;  // the same

  std::list<Posted> posted_;  // not yet known to have left
  Rank rank_ = 0;
  int size_ = 1;
  int local_size_ = 1;
};

}  // namespace understudy::compositor
