#include "reference_cpu/all_pairs.h"

#include "reference_cpu/detectors.h"
#include "reference_cpu/sinks.h"
#include "touchstone/contact.h"

namespace touchstone {

namespace {

// Calls contact(i, j) for each contact, i < j, in ascending order.
template <class Contact>
void for_each_contact(BallsView in, Contact&& contact) {
  for (std::int32_t i = 0; i < in.n; ++i)
    for (std::int32_t j = i + 1; j < in.n; ++j)
      if (in_contact(in.data[i], in.data[j])) contact(i, j);
}

template <class Sink>
void search(BallsView in, Sink sink) {
  for_each_contact(in, [&sink](std::int32_t i, std::int32_t j) { sink.add(i, j); });
  sink.flush();
}

class AllPairs : public Detector {
 public:
  explicit AllPairs(std::int32_t n) : n_(n) {}

  void detect(BallsView in, ContactsView out, Stream&) override {
    require_balls(n_, in, out);
    reset(out);
    if (out.form == OutputForm::pairs)
      search(in, PairSink(out));
    else
      search(in, BallListSink<false>(out));
  }
  DetectorReport report(ContactsView out, Stream&) override { return report_of_host_output(out); }
  std::int64_t workspace_bytes() const override { return 0; }
  DetectorParams params() const override { return {}; }

 private:
  std::int32_t n_;
};

}  // namespace

ContactList all_pairs(std::span<const Ball> balls) {
  ContactList list;
  for_each_contact({balls.data(), static_cast<std::int32_t>(balls.size())}, [&list](std::int32_t i, std::int32_t j) {
    list.pairs.push_back({i, j});
  });
  return list;
}

std::int64_t bytes_of_all_pairs(std::int64_t, const PackingFacts&, const DetectorParams&) { return 0; }

std::unique_ptr<Detector> make_all_pairs(const PackingFacts& facts, const DetectorParams&, Stream&) {
  return std::make_unique<AllPairs>(facts.n);
}

}  // namespace touchstone
