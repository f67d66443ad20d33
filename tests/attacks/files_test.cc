// SPDX-License-Identifier: Apache-2.0
// Clients with the secret that request files of the server's user: they get files in the folders that the
// server named, under any path, and no others.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cerrno>
#include <fstream>
#include <optional>

#include "compositor/service/loading_service.h"
#include "compositor/transport/file_descriptor.h"
#include "tests/attacks/server.h"
#include "tests/clients/command_test.h"
#include "volume/file/file_error.h"
#include "volume/opening/open_volume.h"

namespace attacks {
namespace {

namespace fs = std::filesystem;
using namespace understudy::compositor;
using namespace understudy;
using ::testing::HasSubstr;

constexpr std::size_t bytes = 27;

/// A folder `data` to load from, and a file outside.
class Files : public clients::CommandTest {
 protected:
  Files() {
    fs::create_directories(file("data/below"));
    for (const char* name : {"data/good_3x3x3.raw", "data/below/good_3x3x3.raw", "secret_3x3x3.raw"})
      std::ofstream(file(name)) << std::string(bytes, 'p');
    fs::create_symlink("../secret_3x3x3.raw", file("data/link_3x3x3.raw"));
    fs::create_symlink("good_3x3x3.raw", file("data/inside_3x3x3.raw"));
    fs::create_symlink(file(""), file("data/up"));
    write_header("data/absolute.nrrd", file("secret_3x3x3.raw"));
    write_header("data/relative.nrrd", "../secret_3x3x3.raw");
    write_header("data/honest.nrrd", "good_3x3x3.raw");
    write_meta_image("data/absolute.mhd", file("secret_3x3x3.raw"));
    write_meta_image("data/relative.mhd", "../secret_3x3x3.raw");
    write_meta_image("data/honest.mhd", "good_3x3x3.raw");
  }
  void write_meta_image(const std::string& name, const std::string& data) {
    std::ofstream(file(name)) << "NDims = 3\nDimSize = 3 3 3\nElementType = MET_UCHAR\nElementDataFile = "
                              << data << "\n";
  }
  void write_header(const std::string& name, const std::string& data) {
    std::ofstream(file(name)) << "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 3 3 3\nencoding: raw\ndata file: "
                              << data << "\n";
  }
  std::vector<std::string> forbidden() const {
    return {file("secret_3x3x3.raw"),    file("data/../secret_3x3x3.raw"),
            file("data/link_3x3x3.raw"), file("data/up/secret_3x3x3.raw"),
            file("data/absolute.nrrd"),  file("data/relative.nrrd"),
            file("data/absolute.mhd"),   file("data/relative.mhd"),
            file("nothing_3x3x3.raw"),   "/proc/self/environ"};
  }
  std::vector<std::string> allowed() const {
    return {file("data/good_3x3x3.raw"),       file("data/below/../good_3x3x3.raw"),
            file("data/below/good_3x3x3.raw"), file("data/inside_3x3x3.raw"),
            file("data/honest.nrrd"),          file("data/honest.mhd")};
  }
};

TEST_F(Files, OfAFolderAreReadAndNoOthers) {
  const std::array folders{file("data").string()};
  const volume::ReadableFiles files(folders);
  for (const std::string& path : allowed()) EXPECT_NO_THROW(volume::open_volume(path, {}, files)) << path;
  for (const std::string& path : forbidden()) {
    try {
      volume::open_volume(path, {}, files);
      ADD_FAILURE() << path;
    } catch (const volume::FileError& error) {
      EXPECT_THAT(error.what(), HasSubstr("none of the folders"));
    }
  }
  EXPECT_NO_THROW(volume::open_volume("synthetic:4x4x4", {}, files));
  // Without a list of folders, all files may be read.
  EXPECT_NO_THROW(volume::open_volume(file("data/relative.nrrd")));
}

TEST_F(Files, OfNoFolderAreNotRead) {
  const volume::ReadableFiles none(std::span<const std::string>{});
  for (const std::string& path : allowed())
    EXPECT_THROW(volume::open_volume(path, {}, none), volume::FileError);
}

TEST_F(Files, AFolderThatIsNotThereIsSaid) {
  const std::array folders{file("nowhere").string()};
  EXPECT_THROW(volume::ReadableFiles{folders}, volume::FileError);
}

// Without the kernel's openat2, links are not followed at all.
TEST_F(Files, AreFoundStepByStepToo) {
  const FileDescriptor folder(::open(file("data").c_str(), O_PATH | O_DIRECTORY));
  const auto opens = [&](const std::string& path) {
    const FileDescriptor found(volume::open_beneath_by_walking(folder.get(), path));
    return bool(found);
  };
  EXPECT_TRUE(opens("good_3x3x3.raw"));
  EXPECT_TRUE(opens("below/good_3x3x3.raw"));
  for (const char* path : {"link_3x3x3.raw", "up/secret_3x3x3.raw", "../secret_3x3x3.raw",
                           "below/../../secret_3x3x3.raw", "/etc/passwd"})
    EXPECT_FALSE(opens(path)) << path;
}

/// Why the server does not load `path`; empty if it does.
std::string refusal(LoadingService& service, const std::string& path) {
  LoadRequest request;
  request.volume.id = 7;
  request.volume.size = {3, 3, 3};
  request.volume.stored = {{0, 0, 0}, {3, 3, 3}};
  request.file = path;
  request.hints.size = {3, 3, 3};
  try {
    service.begin_load(request);
  } catch (const RequestRefused& refused) {
    return refused.what();
  }
  return {};
}

TEST_F(Files, AClientOfAServerGetsThoseOfItsDataFoldersAlone) {
  Server server(file(""), {"--data", file("data")});
  const auto service = server.loading_service();
  for (const std::string& path : allowed()) EXPECT_EQ(refusal(*service, path), "") << path;
  for (const std::string& path : forbidden())
    EXPECT_THAT(refusal(*service, path), HasSubstr("lies in none of the folders")) << path;
  // The command-line program reports the same.
  const auto render = [&](const std::string& volume) {
    return run({(clients::programs / "understudy").string(), "render", volume, "--connect", server.socket(),
                "--size", "16x16", "--out", file("out.png").string()});
  };
  EXPECT_EQ(render(allowed().front()).status, 0);
  EXPECT_THAT(render(forbidden().front()).err, HasSubstr("--data FOLDER"));
}

TEST_F(Files, AClientOfAServerGetsNoneWithoutDataFolders) {
  Server server(file(""));
  const auto service = server.loading_service();
  for (const std::string& path : allowed())
    EXPECT_THAT(refusal(*service, path), HasSubstr("load no files for their clients")) << path;
}

TEST_F(Files, OfThisUserAreRenderedWithoutAServerAsEver) {
  const auto render = [&](const clients::Words& options) {
    clients::Words words{(clients::programs / "understudy").string(),
                         "render",
                         file("data/absolute.nrrd").string(),
                         "--size",
                         "16x16",
                         "--out",
                         file("out.png").string()};
    words.insert(words.end(), options.begin(), options.end());
    return run(words);
  };
  for (const clients::Words& options : {clients::Words{}, clients::Words{"-n", "2"}}) {
    const clients::Outcome outcome = render(options);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
  }
}

}  // namespace
}  // namespace attacks
