#include "bench/report/optimum.h"

#include <algorithm>

namespace touchstone::report {

bool overlap(const Row& a, const Row& b) { return a.q1_us <= b.q3_us && b.q1_us <= a.q3_us; }

Optimum optimum(const std::vector<const Row*>& sweep) {
  const auto least =
      std::min_element(sweep.begin(), sweep.end(), [](const Row* a, const Row* b) { return a->median_us < b->median_us; });
  const auto best = static_cast<std::size_t>(least - sweep.begin());
  Optimum o{best, best, best};
  while (o.low > 0 && overlap(*sweep[o.low - 1], **least)) --o.low;
  while (o.high + 1 < sweep.size() && overlap(*sweep[o.high + 1], **least)) ++o.high;
  return o;
}

}  // namespace touchstone::report
