#include "apps/viewer/modes/mode.h"

#include "apps/viewer/modes/core.h"
#include "apps/viewer/modes/rgba.h"
#include "apps/viewer/modes/table.h"

namespace viewer {

std::string_view name_of(ModeKind kind) {
  switch (kind) {
    case ModeKind::rgba:
      return "rgba";
    case ModeKind::table:
      return "table";
    case ModeKind::core:
      return "core";
  }
  return "";
}

std::optional<ModeKind> mode_named(std::string_view name) {
  for (const ModeKind kind : {ModeKind::rgba, ModeKind::table, ModeKind::core})
    if (name_of(kind) == name) return kind;
  return std::nullopt;
}

std::unique_ptr<Mode> make_mode(ModeKind kind, Texels texels, const std::string& file) {
  switch (kind) {
    case ModeKind::rgba:
      return make_rgba_mode(std::move(texels), file);
    case ModeKind::table:
      return make_table_mode(texels, file);
    case ModeKind::core:
      return make_core_mode(texels, file);
  }
  return nullptr;
}

}  // namespace viewer
