#include "peers/peers.h"

namespace touchstone {

std::vector<Peer> built_peers() {
  return {
#if defined(TOUCHSTONE_WITH_ARBORX)
    kArborX,
#endif
#if defined(TOUCHSTONE_WITH_CUNSEARCH)
        kCuNSearch,
#endif
  };
}

}  // namespace touchstone
