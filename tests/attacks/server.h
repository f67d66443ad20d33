// SPDX-License-Identifier: Apache-2.0
// `understudy serve` with one or more nodes, at a socket in the test's folder.
#pragma once

#include <memory>
#include <stdexcept>
#include <string>

#include "compositor/service/loading_service.h"
#include "compositor/service/remote_service.h"
#include "tests/clients/command_test.h"

namespace attacks {

class Server {
 public:
  /// Uses the folder of a clients::CommandTest. Throws std::runtime_error if the server does not start.
  explicit Server(const std::filesystem::path& folder, const clients::Words& options = {}, int nodes = 1)
      : socket_(folder / "nodes.sock"),
        process_({command(options, nodes), {{"XDG_RUNTIME_DIR", folder / "runtime"}}}, own_folder(folder)) {
    const bool there = clients::comes_true(
        [this] { return !process_.running() || process_.out().find("; use ") != std::string::npos; });
    if (!there || !process_.running()) throw std::runtime_error("no server: " + process_.err());
  }

  const std::string& socket() const { return socket_; }
  clients::Child& process() { return process_; }

  std::unique_ptr<understudy::compositor::LoadingService> loading_service() const {
    constexpr std::chrono::seconds patience{60};
    return understudy::compositor::remote_loading_service(socket_,
                                                          {patience, patience, patience, patience, patience});
  }

 private:
  clients::Words command(const clients::Words& options, int nodes) const {
    clients::Words words{
        (clients::programs / "understudy").string(), "serve", "-n", std::to_string(nodes), "--socket", socket_};
    words.insert(words.end(), options.begin(), options.end());
    return words;
  }
  /// Folder for its output.
  static std::filesystem::path own_folder(const std::filesystem::path& folder) {
    std::filesystem::create_directory(folder / "server");
    return folder / "server";
  }

  std::string socket_;
  clients::Child process_;
};

}  // namespace attacks
