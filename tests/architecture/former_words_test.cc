// SPDX-License-Identifier: Apache-2.0
// Words that the glossary (docs/glossary.md) has replaced must not come back, in code, documents or help.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <regex>
#include <string>
#include <string_view>
#include <vector>

#include "tests/architecture/project_files.h"

namespace understudy::testing {
namespace {

struct FormerWord {
  std::string_view stem;  ///< in lower case: only lines that contain it are searched, for speed
  const char* pattern;
  const char* now;
  std::string_view files = "";  ///< paths, between spaces, where it means something else ...
  const char* because = "";     ///< ... and what
};

/// At least one for every row of the glossary. Where the plain word may still be used in another meaning
/// (stage, strip, table, home, note, body, room), these are the identifiers, options and phrases that are gone.
constexpr FormerWord former_words[] = {
    {"picture", "[Pp]icture|PICTURE", "image"},
    {"stage", "StageLink|stage_link|[Ss]tage_?[Pp]rotocol|--stage|stage-opengl|stage_opengl|STAGE_OPENGL",
     "GL server"},
    {"stage", "understudy stage|run_stage|on_stage|\\b(a|our|its|another|whole) stage\\b",
     "GL server, shader stage"},
    {"link", "spu/link\\b|pack link|remote_link|link_driver|link_test", "remote, server connection"},
    {"link", "\\b(Mpi|Thread|Tcp|Forwarding|Counting)Link\\b|\\b(mpi|thread|tcp|forwarding)_link\\b",
     "communicator, TCP connection"},
    {"link", "\\bLink(Lost|Cost|Reader|Wishes|Verdict|Plan|Traffic)\\b|\\blink_(version|patience|cost)",
     "communicator, TCP connection"},
    {"linked", "[Ll]inked_?[Ss]ervice|linked_loading", "remote render service"},
    {"painter", "[Pp]ainter", "tile worker", " volume/kd_tree.h ", "the name of an author"},
    {"polygons", "--polygons|UNDERSTUDY_POLYGONS", "--tiles"},
    {"strip", "spu/strips|[Ss]trip_?[Ss]cissor|\\bstrips\\b", "tile, image partition",
     " volume/file/slices/tiff_image.h volume/file/slices/tiff_image.cc tests/volume/file/tiff_test.cc ",
     "what TIFF calls rows that are compressed together"},
    {"strip", "[Rr]ay_?[Ss]trip|(set_up|walk)_strip|strip_(rays|rows|height)", "ray packet"},
    {"porter", "[Pp]orter", "relay"},
    {"gate", "\\b[Gg]ates?\\b", "listener"},
    {"stranger", "[Ss]tranger", "pending client"},
    {"judge", "\\bJudge\\b|\\bjudge_\\b", "authenticator"},
    {"welcome", "[Ww]elcome", "accept"},
    {"door", "\\b[Dd]oors?\\b|Doors?[A-Z]|door_|_door\\b", "injection method, entry library",
     " interceptor/CMakeLists.txt apps/bench/calls.py ",
     "a folder's name for one release more; the name of a row of measurements"},
    {"body", "understudy-body|interceptor/body|open_body|body_abi|BodyServices", "core library"},
    {"house", "\\b[Hh]ouse\\b|house_test", "architecture"},
    {"room",
     "\\bRooms?\\b|\\brooms\\b|\\b(this|each|every|which|own|topmost|volume) room\\b|shared_room|SharedRoom",
     "module, shared-memory segment"},
    {"bell", "\\b[Bb]ells?\\b", "wake-up"},
    {"rung", "\\brung\\b", "notified"},
    {"ring_", "\\bring_all\\b", "notify"},
    {"note", "take_note|wait_for_note|leave_note|most_note|note_tag|notes_(told|heard)", "control message"},
    {"posted", "\\b[Pp]osted\\b", "control message"},
    {"home",
     "--home\\b|UNDERSTUDY_HOME|[sS]et_home|carry_home|write_home|\\bHome::|comes? home|sent home|written "
     "home|ways? home",
     "gather"},
    {"margin",
     "(give|keep|widen|budget)_margin|margin_(of|needed)|\\.margin\\b|\\b[Mm]argins\\b|margin of "
     "(blocks|cells|texels)",
     "ghost layer"},
    {"leap", "\\b[Ll]eaps?\\b|\\bleap_", "empty-space skipping"},
    {"skip", "[Ss]kip_?[Mm]ap|skip maps?\\b", "occupancy map"},
    {"ray", "rays? ends? early|rays end below", "early ray termination"},
    {"lesser", "[Ll]esser[- _]samples|[Ll]esser_samples", "dominated samples"},
    {"leave", "[Nn]ever[-_]leave|NEVER_LEAVE|\\bLeaveOut\\b|\\bleave_out\\b", "--disable-optimization"},
    {"omission", "[Oo]mission", "optimization"},
    {"empty", "[Ee]mpty-blocks|has_empty_blocks|\\bempty blocks\\b", "empty bricks"},
    {"lamp", "\\b[Ll]amps?\\b|\\b[Ll]amp_|_lamp\\b", "light"},
    {"knot", "\\b[Kk]nots?\\b(?![\"'\\\\:])|[Kk]nots?_|_knots?\\b|Knot[A-Z]|Knots", "control points",
     " apps/understudy/view/page/view.js ", "the key in files of transfer functions"},
    {"pair", "[Pp]air_?[Tt]able|[Pp]air_?[Ll]ookup|[Tt]ables? of pairs|max_pair_edge", "pre-integration table"},
    {"slab", "\\b[Ss]labs?\\b|slab_|_slabs?\\b|Slabs?[A-Z]", "segment, slice range"},
    {"--table", "understudy (render|view)[^|]* --table\\b", "--transfer-function"},
    {"tile", "[Tt]ile_?[Hh]ash|tile of 16", "block"},
    {"doubt", "[Dd]oubt", "refusal"},
    {"left to", "left to the application", "not substituted"},
    {"debt", "[Dd]epth[_ ]?[Dd]ebt", "deferred depth write"},
    {"ow", "\\b[Oo]w(es|ed|ing)\\b", "deferred depth write"},
    {"frame", "[Oo]ne[_ ][Ff]rame[_ ][Bb]ehind|OneFrameBehind", "frame latency"},
    {"pipeline", "--pipeline\\b|UNDERSTUDY_PIPELINE", "--frame-latency"},
    {"fate", "\\b[Ff]ates?\\b", "record action"},
    {"swallow", "[Ss]wallow", "null call, discard"},
    {"slowness", "[Ss]lowness", "relative cost"},
    {"seat", "\\b[Ss]eats?\\b", "session"},
    {"sight", "\\bSight\\b|\\bsight\\.h", "visibility order"},
    {"standing", "\\bStanding\\b", "unit position"},
    {"examination", "[Ee]xamination", "error check"},
    {"circumstances", "[Cc]ircumstances", "prepared key"},
    {"belongings", "[Bb]elongings", "group resources"},
    {"way", "application's way\\b", "native rendering"},
    {"given", "\\b[Gg]iven[_ ]back\\b", "handed back"},
    {"memor", "[Ii]mage[ _]?[Mm]emor(y|ies)\\b", "image buffer"},
    {"nobody", "[Nn]obody would see", "Work that cannot change the image is skipped."},
    {"play", "play the part", "plain sentences"},
};

/// Files that must contain former words: the table of aliases, its test, the glossary, and this file.
constexpr std::string_view tables_of_former_words =
    " spu/former_names.h spu/former_names.cc tests/spu/former_names_test.cc docs/glossary.md"
    " tests/architecture/former_words_test.cc ";

bool is_named(std::string_view files, const std::string& path) {
  return files.find(" " + path + " ") != std::string_view::npos;
}

bool is_text(const std::string& path) {
  constexpr std::array endings{".h",  ".cc",  ".c",    ".cpp", ".py",   ".sh",
                               ".md", ".txt", ".json", ".js",  ".html", ".css"};
  return path == "run" ||
         std::ranges::any_of(endings, [&](const char* ending) { return path.ends_with(ending); });
}

std::string lower(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return text;
}

/// Returns "path:line: found" for every line of `file` with the word; `lowered` is the text in lower case.
std::vector<std::string> lines_with(const FormerWord& word, const std::regex& pattern, const SourceFile& file,
                                    const std::string& lowered) {
  std::vector<std::string> found;
  for (std::size_t at = lowered.find(word.stem); at != std::string::npos; at = lowered.find(word.stem, at)) {
    const std::size_t begin = lowered.rfind('\n', at) + 1,
                      end = std::min(lowered.find('\n', at), lowered.size());
    std::smatch match;
    const std::string line = file.text.substr(begin, end - begin);
    if (std::regex_search(line, match, pattern)) {
      const auto number = 1 + std::count(file.text.begin(), file.text.begin() + std::ptrdiff_t(begin), '\n');
      found.push_back(file.path + ":" + std::to_string(number) + ": \"" + match.str() + "\"");
    }
    at = end;
  }
  return found;
}

TEST(FormerWords, AreGone) {
  for (const SourceFile& file : project_files()) {
    if (!is_text(file.path) || is_named(tables_of_former_words, file.path)) continue;
    const std::string lowered = lower(file.text), path = lower(file.path);
    for (const FormerWord& word : former_words) {
      const bool in_text = lowered.find(word.stem) != std::string::npos;
      if ((!in_text && path.find(word.stem) == std::string::npos) || is_named(word.files, file.path)) continue;
      const std::regex pattern(word.pattern);
      EXPECT_FALSE(std::regex_search(file.path, pattern)) << file.path << ": say \"" << word.now << "\"";
      for (const std::string& line : lines_with(word, pattern, file, lowered))
        ADD_FAILURE() << line << ": say \"" << word.now << "\"";
    }
  }
}

TEST(FormerWords, ExceptionsHaveAReason) {
  for (const FormerWord& word : former_words)
    EXPECT_EQ(word.files.empty(), std::string_view(word.because).empty()) << word.pattern;
}

}  // namespace
}  // namespace understudy::testing
