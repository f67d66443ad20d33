// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/hosts/hostfile.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <ifaddrs.h>
#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <climits>
#include <cstring>
#include <fstream>
#include <memory>
#include <numeric>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string_view>

#include "spu/options.h"

namespace understudy::launcher {
namespace {

constexpr const char* expected = "expected one host per line, as in 'node1 slots=2', comments after '#'";
constexpr std::size_t longest_line = 1024;
constexpr std::size_t most_hosts = spu::max_nodes;

/// No name may begin with '-': a launch agent would take it for an option.
bool is_host_name(std::string_view name) {
  const auto belongs = [](unsigned char c) {
    return std::isalnum(c) != 0 || std::strchr("._-:@", c) != nullptr;
  };
  const std::size_t at = name.find('@');
  const std::string_view host = at == std::string_view::npos ? name : name.substr(at + 1);
  return !name.empty() && !host.empty() && host.find('@') == std::string_view::npos && name.front() != '-' &&
         name.front() != '@' && host.front() != '-' && std::ranges::all_of(name, belongs);
}

int number_of_slots(std::string_view text) {
  int slots = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), slots);
  const bool all = error == std::errc() && end == text.data() + text.size();
  return all && slots >= 1 && slots <= spu::max_nodes ? slots : 0;
}

Host host_of(std::istringstream& words, const std::string& where) {
  Host host;
  words >> host.name;
  if (!is_host_name(host.name))
    throw std::runtime_error(fmt::format("{}: not the name or address of a host; {}", where, expected));
  for (std::string word; words >> word;) {
    const std::size_t equals = word.find('=');
    const std::string key = word.substr(0, equals);
    const bool slots = key == "slots";
    if (equals == std::string::npos || (!slots && key != "max_slots" && key != "max-slots"))
      throw std::runtime_error(
          fmt::format("{}: after '{}' only slots= and max_slots= are allowed; {}", where, host.name, expected));
    const int number = number_of_slots(std::string_view(word).substr(equals + 1));
    if (number == 0)
      throw std::runtime_error(fmt::format("{}: the {} of '{}' must be a number from 1 to {}; {}", where, key,
                                           host.name, spu::max_nodes, expected));
    if (slots) host.slots = number;
  }
  return host;
}

std::string without_user(const std::string& host) {
  const std::size_t at = host.find('@');
  return at == std::string::npos ? host : host.substr(at + 1);
}

std::string short_name(const std::string& host) {
  return host.substr(0, host.find('.'));
}

std::string numeric(const sockaddr* address) {
  if (address == nullptr || (address->sa_family != AF_INET && address->sa_family != AF_INET6)) return {};
  const socklen_t size = address->sa_family == AF_INET ? sizeof(sockaddr_in) : sizeof(sockaddr_in6);
  std::array<char, NI_MAXHOST> text{};
  if (getnameinfo(address, size, text.data(), text.size(), nullptr, 0, NI_NUMERICHOST) != 0) return {};
  return text.data();
}

std::set<std::string> own_addresses() {
  std::set<std::string> found;
  ifaddrs* first = nullptr;
  if (getifaddrs(&first) != 0) return found;
  const std::unique_ptr<ifaddrs, decltype(&freeifaddrs)> all(first, freeifaddrs);
  for (const ifaddrs* interface = first; interface != nullptr; interface = interface->ifa_next)
    if (std::string text = numeric(interface->ifa_addr); !text.empty()) found.insert(std::move(text));
  return found;
}

}  // namespace

std::vector<Host> parse_hostfile(std::istream& text, const std::string& name) {
  std::vector<Host> hosts;
  int number = 0;
  for (std::string line; std::getline(text, line);) {
    const std::string where = fmt::format("hostfile '{}', line {}", name, ++number);
    if (line.size() > longest_line)
      throw std::runtime_error(
          fmt::format("{}: the line is too long, with {} characters; {}", where, line.size(), expected));
    std::istringstream words(line.substr(0, line.find('#')));
    if ((words >> std::ws).eof()) continue;
    const Host host = host_of(words, where);
    const auto known = std::ranges::find(hosts, host.name, &Host::name);
    if (known != hosts.end())
      known->slots = std::min(known->slots + host.slots, spu::max_nodes);
    else
      hosts.push_back(host);
    if (hosts.size() > most_hosts)
      throw std::runtime_error(
          fmt::format("{}: a group can have at most {} hosts; shorten the file", where, most_hosts));
  }
  if (hosts.empty()) throw std::runtime_error(fmt::format("hostfile '{}' lists no host; {}", name, expected));
  return hosts;
}

std::vector<Host> read_hostfile(const std::filesystem::path& file) {
  std::error_code missing;
  const bool folder = std::filesystem::is_directory(file, missing);
  errno = 0;
  std::ifstream stream(file);
  if (folder || !stream)
    throw std::runtime_error(fmt::format("hostfile '{}' cannot be read: {}; {}", file.string(),
                                         std::strerror(folder ? EISDIR : errno), expected));
  return parse_hostfile(stream, file.string());
}

std::string hostfile_text(const std::vector<Host>& hosts) {
  std::string text;
  for (const Host& host : hosts) text += fmt::format("{} slots={}\n", host.name, host.slots);
  return text;
}

bool is_this_machine(const std::string& host) {
  const std::string wanted = without_user(host);
  std::array<char, HOST_NAME_MAX + 1> own{};
  gethostname(own.data(), own.size() - 1);
  const std::string name = own.data();
  if (wanted == "localhost" || wanted == name) return true;
  // If one of the names is short, only the parts before the first dot are compared; two
  // full names must be equal.
  const bool one_is_short = wanted.find('.') == std::string::npos || name.find('.') == std::string::npos;
  if (one_is_short && short_name(wanted) == short_name(name)) return true;
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* first = nullptr;
  if (getaddrinfo(wanted.c_str(), nullptr, &hints, &first) != 0) return false;
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> all(first, freeaddrinfo);
  const std::set<std::string> own_ones = own_addresses();
  for (const addrinfo* found = first; found != nullptr; found = found->ai_next)
    if (own_ones.contains(numeric(found->ai_addr))) return true;
  return false;
}

int slots_of(const std::vector<Host>& hosts) {
  return std::accumulate(hosts.begin(), hosts.end(), 0,
                         [](int sum, const Host& host) { return sum + host.slots; });
}

std::string names_of(const std::vector<Host>& hosts) {
  std::string names;
  for (const Host& host : hosts) names += (names.empty() ? "" : ", ") + host.name;
  return names;
}

}  // namespace understudy::launcher
