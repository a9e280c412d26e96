// The narrow phase of methods that file a ball once, by its centre: `lanes` threads of a block share one ball's search,
// and write its row, or its share of the pair list, themselves.
#pragma once

#include "kernels/contact_writer.h"
#include "touchstone/contact.h"

namespace touchstone {

// Seen by one thread. A block serves blockDim.x / lanes balls; lanes is a power of two, at most 32.
class BallSearch {
 public:
  // Pairs staged for each ball of a block: in a bed a ball finds three or four with j > i.
  static constexpr int kStagedPairs = 6;

  static std::size_t shared_bytes(OutputForm form, int threads, int lanes) {
    const int balls = threads / lanes;
    return form == OutputForm::pairs ? ContactStage::bytes(kStagedPairs * balls) : sizeof(std::int32_t) * balls;
  }

  // All threads of the block together, on dynamic shared memory of shared_bytes().
  __device__ BallSearch(const ContactsView& out, int lanes) : out_(out), lanes_(lanes) {
    const int balls = static_cast<int>(blockDim.x) / lanes;
    if (out_.form == OutputForm::pairs) {
      stage_ = ContactStage::open(dynamic_shared<char>(), kStagedPairs * balls);
    } else {
      row_length_ = dynamic_shared<std::int32_t>() + static_cast<int>(threadIdx.x) / lanes;
      if (lane() == 0) *row_length_ = 0;
    }
    __syncthreads();
  }

  __device__ int lane() const { return static_cast<int>(threadIdx.x) & (lanes_ - 1); }

  // Which ball of all blocks' this thread works for: 0, 1, 2, …
  __device__ std::int64_t place() const {
    return (static_cast<std::int64_t>(blockIdx.x) * blockDim.x + threadIdx.x) / static_cast<unsigned>(lanes_);
  }

  // Tests ball i, which is b and stands at `self`, against the balls at first … last - 1; number[q] names the ball at q.
  __device__ void test(const Ball& b, std::int32_t i, std::int64_t self, const Ball* __restrict__ ball,
                       const std::int32_t* __restrict__ number, std::int64_t first, std::int64_t last) {
    for (std::int64_t q = first + lane(); q < last; q += lanes_)
      if (in_contact(b, ball[q]) && q != self) enter(i, number[q]);
  }

  // All threads of the block together, after their last test(). `found` is false where a thread had no ball.
  __device__ void close(std::int32_t i, bool found) {
    __syncthreads();
    if (out_.form == OutputForm::pairs)
      stage_.write(out_);
    else if (found && lane() == 0)
      out_.length[i] = *row_length_;
  }

 private:
  // Both balls of a contact find it: each enters its own row, and the one of lower number the pair list.
  __device__ void enter(std::int32_t i, std::int32_t j) {
    if (out_.form == OutputForm::ball_lists)
      write_slot(out_, i, atomicAdd(row_length_, 1), j);
    else if (i < j)
      stage_.push(out_, i, j);
  }

  const ContactsView& out_;
  int lanes_;
  ContactStage stage_{};
  std::int32_t* row_length_ = nullptr;
};

}  // namespace touchstone
