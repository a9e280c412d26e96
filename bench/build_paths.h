// Moved: the source tree is found in datasets/source_tree.h.
#pragma once

#include "datasets/source_tree.h"
