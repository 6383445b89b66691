// Any bytes: an error or a valid fog. Checksums are made right first, so that what they guard is
// reached.
#include <cmath>
#include <cstdlib>

#include "wavefog/fogmap/wfog.h"
#include "wfog_bytes.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    std::vector<std::uint8_t> file(data, data + size);
    if (size > 5) wavefog::test::repair_checksums(file);
    wavefog::WfogLimits limits;
    limits.max_map_bytes = 1 << 18;
    limits.threads = 1;
    limits.partial = size % 2 == 0;
    const auto decoded = wavefog::decode_wfog(file, limits);
    if (decoded && (!decoded->fog.validate() || !decoded->map.allFinite())) std::abort();
    return 0;
}
