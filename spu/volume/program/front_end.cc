// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/program/front_end.h"

#include <glslang/MachineIndependent/localintermediate.h>
#include <glslang/Public/ResourceLimits.h>
#include <glslang/Public/ShaderLang.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <memory>
#include <vector>

#include "spu/volume/program/driver_macros.h"

namespace understudy::spu::program {
namespace {

constexpr std::size_t max_source_bytes = 1'000'000;
/// The front end recurses for every level; shaders met so far have no more than twenty.
constexpr int max_nesting = 200;
constexpr EShMessages messages = EShMessages(EShMsgRelaxedErrors | EShMsgSuppressWarnings);

EShLanguage language_of(Stage stage) {
  switch (stage) {
    case Stage::vertex:
      return EShLangVertex;
    case Stage::geometry:
      return EShLangGeometry;
    case Stage::fragment:
      break;
  }
  return EShLangFragment;
}

/// The front end does not clean up when an exception passes through it: its locks stay held, and its tables
/// half made. It is not used again.
constinit std::atomic<bool> is_broken = false;

/// In its scope the front end is used; what it was creating when an exception was thrown is leaked.
template <class Made>
class Asked {
 public:
  explicit Asked(std::unique_ptr<Made>& made) : made_(made) {}
  ~Asked() {
    if (std::uncaught_exceptions() == exceptions_) return;
    is_broken = true;
    static_cast<void>(made_.release());
    // NOLINTNEXTLINE(clang-analyzer-cplusplus.NewDeleteLeaks): it cannot be deleted safely
  }
  Asked(const Asked&) = delete;
  Asked& operator=(const Asked&) = delete;

 private:
  std::unique_ptr<Made>& made_;
  const int exceptions_ = std::uncaught_exceptions();
};

bool initialise() {
  static const bool done = glslang::InitializeProcess();
  return done;
}

int nesting_of(const std::string& source) {
  int depth = 0;
  int deepest = 0;
  for (const char letter : source) {
    if (letter == '(' || letter == '{' || letter == '[') deepest = std::max(deepest, ++depth);
    if (letter == ')' || letter == '}' || letter == ']') --depth;
  }
  return deepest;
}

bool is_too_large(std::span<const std::string> sources) {
  std::size_t bytes = 0;
  for (const std::string& source : sources) bytes += source.size();
  return bytes > max_source_bytes || std::ranges::any_of(sources, [](const std::string& source) {
           return nesting_of(source) > max_nesting;
         });
}

/// Returns the front end's first error, without its prefix.
std::string first_error(const std::string& log) {
  const std::size_t start = log.find("ERROR: ");
  if (start == std::string::npos) return log.substr(0, log.find('\n'));
  const std::size_t first = start + 7;
  return log.substr(first, log.find('\n', first) - first);
}

}  // namespace

struct ParsedStage::Held {
  // Declared before the program, which refers to the shaders.
  std::vector<std::unique_ptr<glslang::TShader>> shaders;
  std::unique_ptr<glslang::TProgram> program;
  const glslang::TIntermediate* tree = nullptr;

  /// Returns an error message; empty: there is none.
  std::string add(EShLanguage language, const std::string& source) {
    const char* text = source.c_str();
    const int length = int(source.size());
    auto& shader = shaders.emplace_back(std::make_unique<glslang::TShader>(language));
    shader->setPreamble(macro_preamble);
    shader->setStringsWithLengths(&text, &length, 1);
    if (!shader->parse(GetDefaultResources(), 110, false, messages)) return first_error(shader->getInfoLog());
    tree = shader->getIntermediate();
    return {};
  }

  std::string link(EShLanguage language) {
    if (shaders.size() == 1) return {};
    program = std::make_unique<glslang::TProgram>();
    for (const auto& shader : shaders) program->addShader(shader.get());
    if (!program->link(messages)) return first_error(program->getInfoLog());
    tree = program->getIntermediate(language);
    return {};
  }

  ~Held() { program.reset(); }
};

ParsedStage::ParsedStage(std::unique_ptr<Held> held) : held_(std::move(held)) {}
ParsedStage::ParsedStage(ParsedStage&&) noexcept = default;
ParsedStage& ParsedStage::operator=(ParsedStage&&) noexcept = default;
ParsedStage::~ParsedStage() = default;

const TIntermNode& ParsedStage::root() const {
  return *held_->tree->getTreeRoot();
}
int ParsedStage::version() const {
  return held_->tree->getVersion();
}

std::variant<ParsedStage, Failure> parse(Stage stage, std::span<const std::string> sources,
                                         const std::optional<std::span<const std::string>>& extensions) {
  if (sources.empty()) return Failure{Failure::Kind::parse, "no source is known"};
  if (is_too_large(sources)) return Failure{Failure::Kind::too_large, "the shader is too large to read"};
  if (is_broken) return Failure{Failure::Kind::unsupported, "the GLSL front end does not start"};
  auto held = std::make_unique<ParsedStage::Held>();
  const Asked asked(held);
  if (!initialise()) return Failure{Failure::Kind::unsupported, "the GLSL front end does not start"};
  const EShLanguage language = language_of(stage);
  std::string error;
  for (const std::string& source : sources) {
    const auto text = with_driver_macros(source, extensions ? &*extensions : nullptr);
    if (const auto* failure = std::get_if<Failure>(&text)) return *failure;
    if (error.empty()) error = held->add(language, std::get<std::string>(text));
  }
  if (error.empty()) error = held->link(language);
  if (!error.empty()) return Failure{Failure::Kind::parse, error};
  if (held->tree == nullptr || held->tree->getTreeRoot() == nullptr)
    return Failure{Failure::Kind::parse, "the shader is empty"};
  return ParsedStage(std::move(held));
}

}  // namespace understudy::spu::program
