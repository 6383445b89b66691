#include "frame.h"

#include <doctest/doctest.h>

using namespace wavefog;

TEST_CASE("supersampling averages blocks, channel by channel") {
    const Image image{4,
                      2,
                      2,
                      {0, 10, 1, 10, 2, 20, 3, 20,  //
                       4, 10, 5, 10, 6, 20, 7, 60}};
    const Image small = cli::box_average(image, 2);
    CHECK(small.width == 2);
    CHECK(small.height == 1);
    CHECK(small.pixels == std::vector<float>{2.5f, 10, 4.5f, 30});
    CHECK(cli::box_average(image, 1).pixels == image.pixels);
}
