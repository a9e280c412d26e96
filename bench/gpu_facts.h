// What the CUDA runtime and the driver say of the GPU in use.
#pragma once

#include <optional>
#include <string>

#include "bench/case.h"

namespace touchstone {

std::string gpu_name();  // "" without a usable GPU
Json gpu_state_json();   // temperature, clocks, power, event reasons now; null without a GPU

// Bits of nvmlClocksEventReasons now; empty without a GPU, or where NVML does not say.
std::optional<unsigned long long> gpu_event_reasons();

}  // namespace touchstone
