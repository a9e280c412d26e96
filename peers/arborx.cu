// ArborX (github.com/arborx/ArborX): a linear bounding volume hierarchy over the spheres, built anew in each run, and three ways
// to ask it; and its brute force. A ball asks with its own radius, so any spread of radii is served.
#include <ArborX_BruteForce.hpp>
#include <ArborX_LinearBVH.hpp>
#include <ArborX_Sphere.hpp>
#include <ArborX_Version.hpp>
#include <Kokkos_Core.hpp>
#include <detail/ArborX_HalfTraversal.hpp>

#include <cstdlib>

#include "peers/adapter.h"
#include "peers/peers.h"

namespace touchstone::arborx {

using Sphere = ArborX::Sphere<3, float>;
using Leaf = ArborX::PairValueIndex<Sphere, std::int32_t>;
using Tree = ArborX::BoundingVolumeHierarchy<Kokkos::CudaSpace, Leaf>;
using All = ArborX::BruteForce<Kokkos::CudaSpace, Leaf>;

// What the tree is built of.
struct Leaves {
  BallsView balls;
};

// What it is asked: one question a ball, which carries the ball along.
struct Questions {
  BallsView balls;
  float reach;
};
struct Asker {
  Ball ball;
  std::int32_t i;
};

KOKKOS_FUNCTION inline Sphere sphere_of(const Ball& b, float more) { return {{b.x, b.y, b.z}, b.r + more}; }
KOKKOS_FUNCTION inline Ball ball_of(const Sphere& s) { return {s.centroid()[0], s.centroid()[1], s.centroid()[2], s.radius()}; }

// A question's candidate: every pair comes twice, from both its balls.
struct TakeLater {
  ContactsView out;

  template <class Question>
  KOKKOS_FUNCTION void operator()(const Question& question, const Leaf& leaf) const {
    const Asker& asker = ArborX::getData(question);
    if (leaf.index <= asker.i) return;
    KOKKOS_IF_ON_DEVICE((append_if_in_contact(out, asker.ball, asker.i, ball_of(leaf.value), leaf.index);))
  }
};

// A half traversal's candidate: every pair comes once.
struct TakeAll {
  ContactsView out;

  KOKKOS_FUNCTION void operator()(const Leaf& a, const Leaf& b) const {
    KOKKOS_IF_ON_DEVICE((append_if_in_contact(out, ball_of(a.value), a.index, ball_of(b.value), b.index);))
  }
};
struct AskWithOwnRadius {
  float reach;

  KOKKOS_FUNCTION auto operator()(const Leaf& leaf) const {
    const Ball b = ball_of(leaf.value);
    return ArborX::intersects(sphere_of(b, slack(b, reach)));
  }
};

}  // namespace touchstone::arborx

template <>
struct ArborX::AccessTraits<touchstone::arborx::Leaves> {
  using memory_space = Kokkos::CudaSpace;
  static KOKKOS_FUNCTION int size(const touchstone::arborx::Leaves& leaves) { return leaves.balls.n; }
  static KOKKOS_FUNCTION auto get(const touchstone::arborx::Leaves& leaves, int i) {
    return touchstone::arborx::Leaf{touchstone::arborx::sphere_of(leaves.balls.data[i], 0), i};
  }
};

template <>
struct ArborX::AccessTraits<touchstone::arborx::Questions> {
  using memory_space = Kokkos::CudaSpace;
  static KOKKOS_FUNCTION int size(const touchstone::arborx::Questions& questions) { return questions.balls.n; }
  static KOKKOS_FUNCTION auto get(const touchstone::arborx::Questions& questions, int i) {
    const touchstone::Ball b = questions.balls.data[i];
    return ArborX::attach(ArborX::intersects(touchstone::arborx::sphere_of(b, touchstone::slack(b, questions.reach))),
                          touchstone::arborx::Asker{b, i});
  }
};

namespace touchstone {
namespace arborx {

// Not before the first detector: whoever counts the processes on the GPU does so before there is a context of ours. The end of
// main comes after the last detector and before CUDA's own end.
void start_kokkos() {
  if (Kokkos::is_initialized()) return;
  int device = 0;
  check(cudaGetDevice(&device));
  Kokkos::initialize(Kokkos::InitializationSettings().set_device_id(device).set_disable_warnings(true));
  std::atexit(Kokkos::finalize);
}

// Kokkos takes large buffers from CUDA's pool where it was built so; the pool then keeps them from one run to the next, which is
// as much of its own buffers as the library can be made to keep.
void keep_freed_memory() {
  int device = 0;
  cudaMemPool_t pool = nullptr;
  std::uint64_t all = ~std::uint64_t{0};
  check(cudaGetDevice(&device));
  check(cudaDeviceGetDefaultMemPool(&pool, device));
  check(cudaMemPoolSetAttribute(pool, cudaMemPoolAttrReleaseThreshold, &all));
}

enum class Way { query, query_as_given, half, brute_force };

template <Way way>
class ArborXDetector final : public PeerDetector {
 public:
  ArborXDetector(const PackingFacts& facts, Stream& stream) : PeerDetector(facts), stream_(stream.get()), space_(stream_) {}

 private:
  void find(BallsView in, ContactsView out, Stream& stream) override {
    if (stream.get() != stream_) throw std::logic_error("ArborX: another stream than the detector was built with");
    const float reach = 2 * rmax_;
    if constexpr (way == Way::brute_force) {
      stream.mark("narrow");
      All(space_, Leaves{in}).query(space_, Questions{in, reach}, TakeLater{out});
      return;
    }
    stream.mark("broad");
    const Tree tree(space_, Leaves{in});
    stream.mark("narrow");
    if constexpr (way == Way::half)
      ArborX::Details::HalfTraversal(space_, tree, TakeAll{out}, AskWithOwnRadius{reach});
    else
      tree.query(space_, Questions{in, reach}, TakeLater{out},
                 ArborX::Experimental::TraversalPolicy().setPredicateSorting(way == Way::query));
  }

  cudaStream_t stream_;
  Kokkos::Cuda space_;
};

template <Way way>
std::unique_ptr<Detector> make(const PackingFacts& facts, const DetectorParams&, Stream& stream) {
  start_kokkos();
  keep_freed_memory();
  return std::make_unique<ArborXDetector<way>>(facts, stream);
}

constexpr DetectorInfo row(const char* layout, const char* summary, decltype(DetectorInfo::make) make) {
  return peer_info("arborx", layout, summary, "rmax", Place::device, make);
}

constexpr PeerRow kRows[] = {
    {row("half", "ArborX: tree walked from each leaf on, as its own neighbour list does: each pair once", make<Way::half>)},
    {row("query", "ArborX: one query a ball, sorted by the library, j > i kept", make<Way::query>)},
    {row("query_as_given", "ArborX: the same in the order of the balls", make<Way::query_as_given>)},
    {row("brute_force", "ArborX: every ball against every other", make<Way::brute_force>), 200'000},
};

std::vector<std::pair<std::string, std::string>> facts() {
  return {
    {"version", ArborX::version()}, {"commit", ArborX::gitCommitHash()},
        {"kokkos", std::to_string(KOKKOS_VERSION / 10000) + "." + std::to_string(KOKKOS_VERSION / 100 % 100) + "." +
                       std::to_string(KOKKOS_VERSION % 100)},
#if defined(KOKKOS_ENABLE_IMPL_CUDA_MALLOC_ASYNC)
        {"allocation", "within each run; Kokkos takes from CUDA's pool, which keeps what is freed"},
#else
        {"allocation", "within each run, by cudaMalloc: Kokkos was built without its CUDA_MALLOC_ASYNC"},
#endif
    {
      "memory", "bytes_peak holds balls and list, not what the library allocates"
    }
  };
}

}  // namespace arborx

const Peer kArborX{"arborx", arborx::kRows, arborx::facts};

}  // namespace touchstone
