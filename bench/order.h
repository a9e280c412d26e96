// The order in which a packing's balls are handed to a detector: an axis of the benchmark, since memory is read in it.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "touchstone/contact_list.h"
#include "touchstone/packing.h"

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

// A contact set of ordered balls in the packing's numbering.
ContactList renumbered(ContactList contacts, std::span<const std::int32_t> number);

}  // namespace touchstone
