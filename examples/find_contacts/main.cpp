// find_contacts PACKING [DETECTOR]: PACKING is a file (.xyz, .csv, .balls) or a recipe such as n=2969,c=4.
#include <cstdio>

#include "datasets/formats.h"
#include "datasets/store.h"
#include "kernels/detection.h"
#include "touchstone/error.h"

int main(int argc, char** argv) try {
  using namespace touchstone;
  if (argc < 2) throw InputError("usage: find_contacts PACKING [DETECTOR]");
  const std::string input = argv[1], name = argc > 2 ? argv[2] : "parallel_levels";
  const bool is_recipe = input.find('=') != std::string::npos;
  const Packing packing = is_recipe ? load_or_make(parse_spec(input), default_packing_folder()) : read_packing(input);

  const DetectorInfo* detector = nullptr;
  for (const DetectorInfo& row : cpu_detectors())
    if (row.label() == name) detector = &row;
#if defined(TOUCHSTONE_HAVE_CUDA)
  for (const DetectorInfo& row : gpu_detectors())
    if (row.label() == name) detector = &row;
#endif
  if (!detector) throw InputError("no detector '" + name + "' in this build");
  if (detector->place == Place::device && device_count() == 0) throw InputError(name + " needs a GPU, and none can be used");

  Stream stream(detector->place);
  const Detection detection = detect_completely(*detector, packing.balls, facts_of(packing.balls), {}, OutputForm::pairs, stream);
  const ContactList contacts = detection.output->download(stream);
  std::printf("%s: %zu contacts, hash %s\n", packing.name.c_str(), contacts.pairs.size(), hex64(contacts.hash()).c_str());
} catch (const std::exception& e) {
  std::fprintf(stderr, "find_contacts: %s\n", e.what());
  return touchstone::kExitInput;
}
