#include "spu/volume/program/analysis.h"

namespace understudy::spu::program {
StageFinding analyse_assembly(const std::string&) noexcept {
  return Failure{};
}
}  // namespace understudy::spu::program
