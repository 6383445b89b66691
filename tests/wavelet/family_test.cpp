#include "wavefog/wavelet/family.h"

#include <doctest/doctest.h>

using namespace wavefog;

TEST_CASE("Default families are those of design.md section 6") {
    CHECK(default_family(0, Form::wavelet).name() == "1,1");
    CHECK(default_family(1, Form::scaling).name() == "2,2");
    CHECK(default_family(2, Form::wavelet).name() == "3,3");
    CHECK(default_family(2, Form::scaling).name() == "3,5");
    CHECK(default_family(3, Form::wavelet).name() == "4,6");
    CHECK(default_family(4, Form::wavelet).name() == "chui-wang");
    for (int degree = 0; degree <= max_degree; ++degree)
        for (const Form form : {Form::wavelet, Form::scaling})
            CHECK(default_family(degree, form).stable());
}

TEST_CASE("Every family's name parses back to it") {
    for (int degree = 0; degree <= max_degree; ++degree)
        for (const Family& family : families(degree)) {
            const auto parsed = parse_family(family.name(), degree);
            REQUIRE(parsed.has_value());
            CHECK(*parsed == family);
        }
}

TEST_CASE("An unknown family lists what there is for the basis") {
    const auto parsed = parse_family("3,3", 1);
    REQUIRE_FALSE(parsed.has_value());
    CHECK(parsed.error().kind == ErrorKind::usage);
    CHECK(parsed.error().message ==
          "family \"3,3\": not known for basis linear; use one of 2,0, 2,2, 2,4, chui-wang, "
          "positive");
}

TEST_CASE("The unstable families, and only they, warn with their growth") {
    int unstable = 0;
    for (int degree = 0; degree <= 5; ++degree)
        for (const Family& family : families(degree)) {
            CHECK(family.warning().empty() == family.stable());
            unstable += family.stable() ? 0 : 1;
        }
    CHECK(unstable == 4);
    CHECK(Family{Family::Kind::cdf, 3, 2}.warning() ==
          "family 4,2 is unstable: its condition number grows 1.77 times with every level; use 4,6 "
          "unless you study this");
    CHECK(Family{Family::Kind::cdf, 2, 1}.condition_growth() == doctest::Approx(1.47));
    CHECK(Family{Family::Kind::cdf, 3, 4}.condition_growth() == doctest::Approx(1.15));
    CHECK(Family{Family::Kind::cdf, 1, 0}.condition_growth() == doctest::Approx(1.41));
}

TEST_CASE("Basis names parse back, others are refused") {
    for (int degree = 0; degree <= max_degree; ++degree)
        CHECK(*parse_basis(basis_name(degree)) == degree);
    CHECK(*parse_basis("degree-2") == 2);
    for (const char* text : {"", "Haar", "degree-", "degree--1", "degree-16", "degree-1x", "4"}) {
        const auto parsed = parse_basis(text);
        REQUIRE_FALSE(parsed.has_value());
        CHECK(parsed.error().message.find("quadratic") != std::string::npos);
    }
}
