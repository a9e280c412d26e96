// An oracle that shares nothing with our grids: Boost.Geometry's R-tree gives the candidates, in_contact() decides.
#pragma once

#define BOOST_ALLOW_DEPRECATED_HEADERS  // Boost 1.74 warns of its own
#include <boost/geometry.hpp>
#include <boost/geometry/index/rtree.hpp>
#include <iterator>
#include <span>
#include <utility>
#include <vector>

#include "touchstone/contact.h"
#include "touchstone/contact_list.h"

namespace touchstone {

// All contacts of `balls`, pairs in ascending order. Boxes are taken in double, where a float centre plus or minus a float
// radius has no rounding that matters, and made larger by 10^-6 of their width, more than in_contact() can round.
inline ContactList rtree_contacts(std::span<const Ball> balls) {
  namespace bg = boost::geometry;
  using Point = bg::model::point<double, 3, bg::cs::cartesian>;
  using BoundingBox = bg::model::box<Point>;
  using Entry = std::pair<BoundingBox, std::int32_t>;
  const auto box_of = [](const Ball& b) {
    const double x = b.x, y = b.y, z = b.z, reach = b.r * (1 + 1e-6);
    return BoundingBox({x - reach, y - reach, z - reach}, {x + reach, y + reach, z + reach});
  };

  std::vector<Entry> entries;
  for (std::size_t i = 0; i < balls.size(); ++i) entries.push_back({box_of(balls[i]), static_cast<std::int32_t>(i)});
  const bg::index::rtree<Entry, bg::index::rstar<16>> tree(entries);

  ContactList list;
  std::vector<Entry> candidates;
  for (const auto& [box, i] : entries) {
    candidates.clear();
    tree.query(bg::index::intersects(box), std::back_inserter(candidates));
    for (const auto& [other, j] : candidates)
      if (i < j && in_contact(balls[i], balls[j])) list.pairs.push_back({i, j});
  }
  return from_pairs(std::move(list.pairs), static_cast<std::int32_t>(balls.size()));
}

}  // namespace touchstone
