#include "bench/contact_judge.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace touchstone {
namespace {

// One entry as a word that sorts by unordered pair, then by direction: indices have 31 bits.
std::uint64_t key_of(Pair p) {
  const std::uint64_t low = static_cast<std::uint32_t>(std::min(p.i, p.j)), high = static_cast<std::uint32_t>(std::max(p.i, p.j));
  return low << 32 | high << 1 | (p.i > p.j ? 1u : 0u);
}

// All entries of one unordered pair.
struct Group {
  Pair pair;  // i < j
  std::int64_t forward = 0, backward = 0;
};

template <class Visit>
void for_each_group(const std::vector<std::uint64_t>& keys, const Visit& visit) {
  for (std::size_t k = 0; k < keys.size();) {
    const std::uint64_t pair = keys[k] >> 1;
    Group g{{static_cast<std::int32_t>(pair >> 31), static_cast<std::int32_t>(pair & 0x7FFFFFFF)}};
    for (; k < keys.size() && keys[k] >> 1 == pair; ++k) ++(keys[k] & 1 ? g.backward : g.forward);
    visit(g);
  }
}

class Judge {
 public:
  Judge(std::span<const Ball> balls, const BorderlineRule& rule, std::size_t limit) : balls_(balls), rule_(rule), limit_(limit) {}

  bool borderline(Pair p) const {
    const Ball &a = balls_[p.i], &b = balls_[p.j];
    return std::abs(gap_m(a, b)) <= rounding_bound_m(a, b, rule_);
  }

  // A fault that rounding may explain (`may_be_borderline`) or not.
  void add(Findings& kind, Pair p, bool may_be_borderline, std::int64_t times = 1) const {
    const bool excused = may_be_borderline && borderline(p);
    kind.count += times;
    if (excused) kind.borderline += times;
    std::vector<Finding>& examples = excused ? kind.borderline_examples : kind.examples;
    if (examples.size() < limit_) examples.push_back({p.i, p.j, gap_m(balls_[p.i], balls_[p.j]), excused});
  }

 private:
  std::span<const Ball> balls_;
  BorderlineRule rule_;
  std::size_t limit_;
};

}  // namespace

double gap_m(const Ball& a, const Ball& b) {
  const double dx = double{a.x} - b.x, dy = double{a.y} - b.y, dz = double{a.z} - b.z;
  return std::sqrt(dx * dx + dy * dy + dz * dz) - (double{a.r} + b.r);
}

double rounding_bound_m(const Ball& a, const Ball& b, const BorderlineRule& rule) {
  constexpr double u = 0x1p-24;
  const double s = double{a.r} + b.r;
  double bound = 0;
  if (rule.rounding == Rounding::float64) bound = 4 * u * s;
  if (rule.rounding == Rounding::float32) {
    const double ax = std::abs(double{a.x}) + std::abs(double{b.x}), ay = std::abs(double{a.y}) + std::abs(double{b.y}),
                 az = std::abs(double{a.z}) + std::abs(double{b.z});
    bound = 2 * u * std::sqrt(ax * ax + ay * ay + az * az) + 11 * u * s;
  }
  // Exact means that no pair is excused, not even one that touches exactly.
  if (bound == 0 && rule.tolerance_m == 0) return -1;
  return bound * (1 + 0x1p-20) + rule.tolerance_m;
}

std::string_view to_string(ListForm form) { return form == ListForm::full ? "full" : form == ListForm::half ? "half" : "auto"; }

bool Judgement::different() const {
  return missing.firm() > 0 || extra.firm() > 0 || one_way.firm() > 0 || duplicates.count > 0 || self.count > 0;
}

bool Judgement::only_borderline() const { return !different() && (missing.count > 0 || extra.count > 0 || one_way.count > 0); }

Judgement judge(std::span<const Ball> balls, const ContactList& reference, std::span<const Pair> entries,
                const BorderlineRule& rule, ListForm form, std::size_t limit) {
  const Judge found(balls, rule, limit);
  Judgement result;
  result.reference = reference.count();
  result.entries = static_cast<std::int64_t>(entries.size());
  for (const Pair& p : reference.pairs) result.reference_borderline += found.borderline(p);

  std::vector<std::uint64_t> keys;
  keys.reserve(entries.size());
  const auto n = static_cast<std::int64_t>(balls.size());
  for (const Pair& p : entries) {
    if (p.i < 0 || p.j < 0 || p.i >= n || p.j >= n) throw std::logic_error("judge: an index outside the packing");
    if (p.i == p.j)
      found.add(result.self, p, false);
    else
      keys.push_back(key_of(p));
  }
  std::sort(keys.begin(), keys.end());
  std::int64_t both = 0;
  for_each_group(keys, [&](const Group& g) {
    ++result.distinct;
    both += g.forward > 0 && g.backward > 0;
  });
  const bool full = form == ListForm::full || (form == ListForm::automatic && 2 * both > result.distinct);
  result.form = full ? ListForm::full : ListForm::half;

  auto next = reference.pairs.begin();
  for_each_group(keys, [&](const Group& g) {
    for (; next != reference.pairs.end() && *next < g.pair; ++next) found.add(result.missing, *next, true);
    const bool touches = next != reference.pairs.end() && *next == g.pair;
    if (touches)
      ++next;
    else
      found.add(result.extra, g.pair, true);
    if (full && touches && (g.forward == 0 || g.backward == 0)) found.add(result.one_way, g.pair, true);
    const std::int64_t surplus =
        full ? std::max<std::int64_t>(g.forward - 1, 0) + std::max<std::int64_t>(g.backward - 1, 0) : g.forward + g.backward - 1;
    if (surplus > 0) found.add(result.duplicates, g.pair, false, surplus);
  });
  for (; next != reference.pairs.end(); ++next) found.add(result.missing, *next, true);
  return result;
}

}  // namespace touchstone
