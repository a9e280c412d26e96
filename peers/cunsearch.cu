// cuNSearch (github.com/InteractiveComputerGraphics/cuNSearch): neighbours of points within one radius, so it is asked for
// 2 rmax, and its lists are filtered on the device. Its interface takes positions and gives lists on the host: the lists cross to
// the host within each run, and the filter reads them from there. It does not name two balls with one centre as neighbours.
#include <cuNSearch.h>

#include "peers/adapter.h"
#include "peers/peers.h"

namespace touchstone {
namespace cunsearch {

using cuNSearch::Real;

// A ball's neighbours as the library keeps them: pinned memory, which kernels can read.
struct Row {
  const unsigned int* first;
  unsigned int length;
};

// Memory that host and device both reach.
template <class T>
class SharedArray {
 public:
  enum class Kind { managed, pinned };  // that moves to who uses it; that stays on the host
  SharedArray(std::size_t size, Kind kind) : kind_(kind) {
    const std::size_t bytes = size > 0 ? size * sizeof(T) : 1;
    check(kind == Kind::managed ? cudaMallocManaged(&data_, bytes) : cudaMallocHost(&data_, bytes));
  }
  ~SharedArray() { kind_ == Kind::managed ? cudaFree(data_) : cudaFreeHost(data_); }
  SharedArray(const SharedArray&) = delete;
  SharedArray& operator=(const SharedArray&) = delete;
  T* data() const { return data_; }

 private:
  Kind kind_;
  T* data_ = nullptr;
};

constexpr int kThreads = 256;

// One thread a ball: its centre, as the library wants it.
__global__ void centres_kernel(BallsView in, Real* centre) {
  const std::int32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i >= in.n) return;
  const Ball b = in.data[i];
  centre[3 * std::int64_t{i}] = b.x;
  centre[3 * std::int64_t{i} + 1] = b.y;
  centre[3 * std::int64_t{i} + 2] = b.z;
}

// One warp a ball: those of its neighbours that come later and touch it.
__global__ void filter_kernel(BallsView in, const Row* rows, ContactsView out) {
  const std::int64_t i = (std::int64_t{blockIdx.x} * blockDim.x + threadIdx.x) / warpSize;
  if (i >= in.n) return;
  const Row row = rows[i];
  const Ball own = in.data[i];
  for (unsigned int k = threadIdx.x % warpSize; k < row.length; k += warpSize) {
    const auto j = static_cast<std::int32_t>(row.first[k]);
    if (j > i) append_if_in_contact(out, own, static_cast<std::int32_t>(i), in.data[j], j);
  }
}

unsigned int blocks_for(std::int64_t threads) { return static_cast<unsigned int>((threads + kThreads - 1) / kThreads); }

class CuNSearchDetector final : public PeerDetector {
 public:
  explicit CuNSearchDetector(const PackingFacts& facts)
      : PeerDetector(facts),
        centres_(3 * static_cast<std::size_t>(facts.n), SharedArray<Real>::Kind::managed),
        rows_(static_cast<std::size_t>(facts.n), SharedArray<Row>::Kind::pinned),
        search_(static_cast<Real>(radius_of(facts))) {
    check(cudaMemset(centres_.data(), 0, 3 * sizeof(Real) * static_cast<std::size_t>(facts.n)));  // it is read at once
    search_.add_point_set(centres_.data(), static_cast<std::size_t>(facts.n), /*is_dynamic=*/true);
  }
  std::int64_t workspace_bytes() const override {
    return std::int64_t{n_} * static_cast<std::int64_t>(3 * sizeof(Real) + sizeof(Row));  // and what the library allocates
  }

 private:
  static float radius_of(const PackingFacts& facts) {
    float furthest = 0;
    for (int axis = 0; axis < 3; ++axis)
      furthest = std::max({furthest, std::abs(facts.centres.lower[axis]), std::abs(facts.centres.upper[axis])});
    const float reach = 2 * facts.rmax;
    return reach + slack({furthest, furthest, furthest, facts.rmax}, reach);
  }

  void find(BallsView in, ContactsView out, Stream& stream) override {
    stream.mark("centres");
    centres_kernel<<<blocks_for(in.n), kThreads, 0, stream.get()>>>(in, centres_.data());
    check(cudaGetLastError());
    stream.synchronize();  // the library works in the default stream, which ours does not wait for
    stream.mark("library");
    search_.find_neighbors();
    stream.mark("rows");
    const cuNSearch::PointSet& set = search_.point_set(0);
    for (std::int32_t i = 0; i < in.n; ++i)
      rows_.data()[i] = {set.neighbor_list(0, i), static_cast<unsigned int>(set.n_neighbors(0, i))};
    stream.mark("filter");
    filter_kernel<<<blocks_for(32 * std::int64_t{in.n}), kThreads, 0, stream.get()>>>(in, rows_.data(), out);
    check(cudaGetLastError());
  }

  SharedArray<Real> centres_;
  SharedArray<Row> rows_;
  cuNSearch::NeighborhoodSearch search_;
};

std::unique_ptr<Detector> make(const PackingFacts& facts, const DetectorParams&, Stream&) {
  return std::make_unique<CuNSearchDetector>(facts);
}

constexpr PeerRow kRows[] = {
    {peer_info("cunsearch", "", "cuNSearch: neighbours within 2 rmax, filtered", "rmax,box", Place::device, make)},
};

std::vector<std::pair<std::string, std::string>> facts() {
  return {
      {"version", "none given; library of SHA-256 " TOUCHSTONE_CUNSEARCH_SHA256},
      {"precision", sizeof(Real) == 4 ? "float32" : "float64"},
      {"transfers", "within each run its lists go to the host, and the filter reads them there: its interface has no other way"},
      {"memory", "bytes_peak holds balls, list and centres, not what the library allocates"}};
}

}  // namespace cunsearch

const Peer kCuNSearch{"cunsearch", cunsearch::kRows, cunsearch::facts};

}  // namespace touchstone
