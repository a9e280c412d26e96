#include "bench/order.h"

#include <algorithm>
#include <numeric>

#include "touchstone/grid.h"

namespace touchstone {
namespace {

// 21 bits of a coordinate spread to every third bit.
std::uint64_t spread(std::uint64_t v) {
  v &= 0x1FFFFF;
  v = (v | v << 32) & 0x1F00000000FFFF;
  v = (v | v << 16) & 0x1F0000FF0000FF;
  v = (v | v << 8) & 0x100F00F00F00F00F;
  v = (v | v << 4) & 0x10C30C30C30C30C3;
  v = (v | v << 2) & 0x1249249249249249;
  return v;
}

std::vector<std::uint64_t> morton_codes(std::span<const Ball> balls, const PackingFacts& facts) {
  const Grid grid = make_grid(facts.centres, 2 * facts.ravg);
  std::vector<std::uint64_t> codes;
  for (const Ball& b : balls)
    codes.push_back(spread(cell_coordinate(b.x, grid.x0, grid.inv_h, grid.nx)) |
                    spread(cell_coordinate(b.y, grid.y0, grid.inv_h, grid.ny)) << 1 |
                    spread(cell_coordinate(b.z, grid.z0, grid.inv_h, grid.nz)) << 2);
  return codes;
}

}  // namespace

std::string_view to_string(Order order) {
  switch (order) {
    case Order::shuffled:
      return "shuffled";
    case Order::sorted:
      return "sorted";
    default:
      return "as_settled";
  }
}

OrderedBalls in_order(std::span<const Ball> balls, const PackingFacts& facts, Order order) {
  OrderedBalls result{{balls.begin(), balls.end()}, {}};
  if (order == Order::shuffled || balls.empty()) return result;
  result.number.resize(balls.size());
  std::iota(result.number.begin(), result.number.end(), 0);
  if (order == Order::sorted) {
    const std::vector<std::uint64_t> codes = morton_codes(balls, facts);
    std::stable_sort(result.number.begin(), result.number.end(), [&](auto a, auto b) { return codes[a] < codes[b]; });
  } else {
    std::stable_sort(result.number.begin(), result.number.end(), [&](auto a, auto b) { return balls[a].z < balls[b].z; });
  }
  for (std::size_t k = 0; k < balls.size(); ++k) result.balls[k] = balls[result.number[k]];
  return result;
}

Numbering numbering_of(const OrderedBalls& ordered) {
  Numbering number;
  if (!ordered.number.empty()) number.table = ordered.number.data();
  return number;
}

ContactList renumbered(ContactList contacts, const Numbering& number, std::int32_t n) {
  if (number.is_identity()) return contacts;
#pragma omp parallel for
  for (std::size_t k = 0; k < contacts.pairs.size(); ++k) {
    const std::int32_t i = number(contacts.pairs[k].i), j = number(contacts.pairs[k].j);
    contacts.pairs[k] = {std::min(i, j), std::max(i, j)};
  }
  sort_pairs(contacts.pairs, n);
  return contacts;
}

}  // namespace touchstone
