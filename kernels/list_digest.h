// touchstone/list_digest.h on the device: a list of 10^9 contacts is judged without travelling.
#pragma once

#include "kernels/device.h"
#include "touchstone/list_digest.h"

namespace touchstone {

// Of a list on the device; a table in `number` lies there too. Reads the list once (8 bytes a pair), the count where it lies;
// synchronises the stream.
ListDigest digest_on_device(const ContactsView& list, const Numbering& number, Stream& stream);

}  // namespace touchstone
