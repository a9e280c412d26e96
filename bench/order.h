// The order in which a packing's balls are handed to a detector: an axis of the benchmark, since memory is read in it.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "touchstone/contact_list.h"
#include "touchstone/packing.h"
#include "touchstone/shuffle.h"

namespace touchstone {

enum class Order {
  shuffled,   // the packing's own numbering, which is random; of tiled packings (bench/tiled.h) a shuffle of it
  sorted,     // by Morton code of cells of 2 ravg, ties by number; of tiled packings tile after tile, each so
  as_settled  // by height of the centre, ties by number: as a bed fills, and as a simulation that adds balls in turn holds them
};
std::string_view to_string(Order order);

struct OrderedBalls {
  std::vector<Ball> balls;
  std::vector<std::int32_t> number;  // balls[k] is the packing's ball number[k]; empty for shuffled, where it is ball k
};
OrderedBalls in_order(std::span<const Ball> balls, const PackingFacts& facts, Order order);

// Which ball each place of `ordered` holds; refers to its table.
Numbering numbering_of(const OrderedBalls& ordered);

// A contact set of ordered balls, `n` in all, in the packing's numbering.
ContactList renumbered(ContactList contacts, const Numbering& number, std::int32_t n);

}  // namespace touchstone
