// Study `hostile`: a settled bed's balls laid out so that grids have a hard time, beside the bed.
#pragma once

#include "bench/report/figure.h"
#include "bench/report/table.h"

namespace touchstone::report {

// A row a packing: contacts, fullest cell, and of every detector ns a ball with the ratio to the bed's; what was refused says why
// in a note.
Table hostile_table(const Device& device);

// A panel for each place: ns a ball over the bed's, and contacts a ball over the bed's.
Figure hostile_figure(const Device& device);

}  // namespace touchstone::report
