#include "bench/occupancy.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "touchstone/error.h"

namespace touchstone {
namespace {

constexpr int kWarp = 32;

// 1.3 and 2.0: NVIDIA's CUDA_Occupancy_Calculator.xls, version 5.1, sheet "GPU Data", and the CUDA C Programming Guide 3.x,
// section 4.2 (how registers are given) and appendix G.1 (limits). 9.0: CUDA C++ Programming Guide 13.0, appendix "Compute
// Capabilities", and NVIDIA's cuda_occupancy.h, which tests/occupancy_test.cpp compares with where a toolkit is installed.
// Left out: on 2.0 later versions of the spreadsheet give twice the portion for eight register counts (21, 22, 29, 30, …).
constexpr MultiprocessorLimits kKnown[] = {
    {.compute_capability = "1.3",
     .warps = 32,
     .blocks = 8,
     .threads_a_block = 512,
     .registers = 16384,
     .registers_a_thread = 124,
     .register_unit = 512,
     .registers_by_warp = false,
     .warp_unit = 2,
     .shared_bytes = 16384,
     .shared_unit = 512,
     .shared_bytes_a_block = 16384,
     .reserved_shared_bytes = 0},  // a kernel's arguments live in shared memory too: the compiler's figure includes them
    {.compute_capability = "2.0",
     .warps = 48,
     .blocks = 8,
     .threads_a_block = 1024,
     .registers = 32768,
     .registers_a_thread = 63,
     .register_unit = 64,
     .registers_by_warp = true,
     .warp_unit = 2,
     .shared_bytes = 49152,
     .shared_unit = 128,
     .shared_bytes_a_block = 49152,
     .reserved_shared_bytes = 0},
    {.compute_capability = "9.0",
     .warps = 64,
     .blocks = 32,
     .threads_a_block = 1024,
     .registers = 65536,
     .registers_a_thread = 255,
     .register_unit = 256,
     .registers_by_warp = true,
     .warp_unit = 4,
     .shared_bytes = 228 * 1024,
     .shared_unit = 128,
     .shared_bytes_a_block = 227 * 1024,
     .reserved_shared_bytes = 1024},
};

int round_up(int value, int unit) { return (value + unit - 1) / unit * unit; }
int round_down(int value, int unit) { return value / unit * unit; }

int blocks_by_registers(const MultiprocessorLimits& m, int warps, int registers) {
  if (registers > m.registers_a_thread) return 0;
  if (registers == 0) return m.blocks;
  if (m.registers_by_warp) {
    const int warps_held = round_down(m.registers / round_up(registers * kWarp, m.register_unit), m.warp_unit);
    return warps_held / warps;
  }
  return m.registers / round_up(round_up(warps, m.warp_unit) * kWarp * registers, m.register_unit);
}

int blocks_by_shared_memory(const MultiprocessorLimits& m, int bytes) {
  if (bytes > m.shared_bytes_a_block) return 0;
  const int given = round_up(bytes + m.reserved_shared_bytes, m.shared_unit);
  return given == 0 ? m.blocks : m.shared_bytes / given;
}

}  // namespace

std::span<const MultiprocessorLimits> known_multiprocessors() { return kKnown; }

const MultiprocessorLimits& multiprocessor(std::string_view compute_capability) {
  std::string known;
  for (const MultiprocessorLimits& m : kKnown) {
    if (m.compute_capability == compute_capability) return m;
    known += fmt::format("{}{}", known.empty() ? "" : ", ", m.compute_capability);
  }
  throw InputError(fmt::format("compute capability '{}': occupancy arithmetic knows {}", compute_capability, known));
}

Occupancy occupancy(const MultiprocessorLimits& m, const KernelNeeds& needs) {
  if (needs.threads < 1 || needs.registers < 0 || needs.shared_bytes < 0)
    throw InputError(
        fmt::format("occupancy of {} threads, {} registers, {} B of shared memory: threads must be at least 1, "
                    "the others not negative",
                    needs.threads, needs.registers, needs.shared_bytes));
  const int warps = (needs.threads + kWarp - 1) / kWarp;
  const struct {
    std::string_view name;
    int blocks;
  } limits[] = {{"warps", needs.threads > m.threads_a_block ? 0 : m.warps / warps},
                {"blocks", m.blocks},
                {"registers", blocks_by_registers(m, warps, needs.registers)},
                {"shared memory", blocks_by_shared_memory(m, needs.shared_bytes)}};
  const auto& least =
      *std::min_element(std::begin(limits), std::end(limits), [](const auto& a, const auto& b) { return a.blocks < b.blocks; });
  Occupancy o;
  o.blocks = least.blocks;
  o.warps = o.blocks * warps;
  o.share = static_cast<double>(o.warps) / m.warps;
  o.limited_by = least.name;
  return o;
}

}  // namespace touchstone
