#include "options.h"

#include <doctest/doctest.h>

#include <limits>

using namespace wavefog;
using namespace wavefog::cli;

namespace {

std::string error_of(const auto& result) {
    return result ? "" : result.error().message;
}

}  // namespace

TEST_CASE("numbers are whole, finite and decimal") {
    for (const char* text : {"0", "-1.5", "+2", "1e-3", ".5", "5.", "1e300"})
        CHECK_MESSAGE(parse_number(text), text);
    CHECK(*parse_number("-1.5") == -1.5);
    CHECK(*parse_number("+2") == 2);
    for (const char* text : {"", " ", "nan", "inf", "-inf", "1e400", "1x", "1 ", " 1", "0x10",
                             "1,5", "--1", "+-1", "+", "e5", "1e"})
        CHECK_MESSAGE(!parse_number(text), text);
}

TEST_CASE("ranges include their ends and are named") {
    CHECK(parse_number_in("0", 0, 1));
    CHECK(parse_number_in("1", 0, 1));
    CHECK(error_of(parse_number_in("1.01", 0, 1)) == "1.01 is out of range; use 0 to 1");
    CHECK(error_of(parse_number_in("-1", 0, std::numeric_limits<double>::infinity())) ==
          "-1 is out of range; use 0 or more");
    CHECK(parse_integer_in("16", 1, 16));
    for (const char* text : {"0", "17", "1.0", "2x", "", "99999999999"})
        CHECK_MESSAGE(!parse_integer_in(text, 1, 16), text);
}

TEST_CASE("rectangles have an area") {
    const Rect expected{-200, -100.5, 200, 1e3};
    CHECK(*parse_rect("-200,-100.5,200,1e3") == expected);
    for (const char* text : {"0,0,1", "0,0,1,1,1", "0,0,0,1", "1,0,0,1", "0,0,1,nan", "0,0,,1", ""})
        CHECK_MESSAGE(!parse_rect(text), text);
}

TEST_CASE("profiles read back as they are written") {
    for (const char* text : {"uniform", "slab:0,10", "exponential:-5,8.25", "linear:1,20"}) {
        const Result<Profile> profile = parse_profile(text);
        REQUIRE_MESSAGE(profile, text);
        CHECK(profile_text(*profile) == text);
    }
    for (const char* text :
         {"", "box", "uniform:1,2", "slab", "slab:", "slab:1", "slab:10,0", "slab:1,1",
          "exponential:0,0", "exponential:0,-8", "exponential:0,nan", "linear:5,1", "linear:1,2,3"})
        CHECK_MESSAGE(!parse_profile(text), text);
}

TEST_CASE("sizes and levels") {
    CHECK(parse_size("800x600")->width == 800);
    CHECK(parse_size("800x600")->height == 600);
    for (const char* text :
         {"", "800", "800x", "x600", "0x600", "-1x5", "800x600x3", "800X600", "16385x1", "1.5x2"})
        CHECK_MESSAGE(!parse_size(text), text);
    CHECK(*parse_levels("auto") == -1);
    CHECK(*parse_levels("0") == 0);
    CHECK(!parse_levels("-1"));
    CHECK(!parse_levels("many"));
}

TEST_CASE("choices list what there is") {
    CHECK(*parse_choice("b", {"a", "b"}) == 1);
    CHECK(error_of(parse_choice("c", {"a", "b"})) == "'c' is not known; use a, b");
}
