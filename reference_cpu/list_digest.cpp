#include "touchstone/list_digest.h"

namespace touchstone {

ListDigest digest_on_host(const ContactsView& list, const Numbering& number) {
  ListDigest total;
  const std::int64_t entries = ListDigest::entries(list);
#pragma omp parallel
  {
    ListDigest mine;
#pragma omp for nowait
    for (std::int64_t at = 0; at < entries; ++at) mine.add_entry(list, at, number);
#pragma omp critical(touchstone_list_digest)
    total.add(mine);
  }
  return total;
}

}  // namespace touchstone
