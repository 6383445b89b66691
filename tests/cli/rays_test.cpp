#include "rays.h"

#include <doctest/doctest.h>

#include <sstream>

using namespace wavefog::cli;

namespace {

wavefog::Result<RayTable> read(const std::string& text) {
    std::istringstream stream(text);
    return read_rays(stream, "r.csv");
}

}  // namespace

TEST_CASE("rays with and without a header, in any line ends") {
    for (const char* text :
         {"1,2,3,4,5,6\n-1,2e3,+3,4,5,6.5\n", "1,2,3,4,5,6\r\n\r\n-1,2e3,+3,4,5,6.5",
          "\xEF\xBB\xBF"
          "1,2,3,4,5,6\n-1,2e3,+3,4,5,6.5\n",
          " 1 ,2,3,\t4,5,6\n-1,2e3,+3,4,5,6.5 \n"}) {
        const auto table = read(text);
        REQUIRE_MESSAGE(table, text);
        CHECK(table->header.empty());
        REQUIRE(table->rays.size() == 2);
        CHECK(table->rays[0].origin == Eigen::Vector3d(1, 2, 3));
        CHECK(table->rays[0].end == Eigen::Vector3d(4, 5, 6));
        CHECK(table->rays[1].origin == Eigen::Vector3d(-1, 2000, 3));
        CHECK(table->rays[1].text == "-1,2e3,+3,4,5,6.5");
    }
    const auto with_header = read("ox,oy,oz,px,py,pz\n1,2,3,4,5,6\n");
    REQUIRE(with_header);
    CHECK(with_header->header == "ox,oy,oz,px,py,pz");
    CHECK(with_header->rays.size() == 1);
}

TEST_CASE("wrong rays are named by line and column") {
    struct Case {
        const char* text;
        const char* message;
    };
    for (const Case& c : {
             Case{"1,2,3,4,5\n", "r.csv: line 1 has 5 columns;"},
             Case{"1,2,3,4,5,6\n1,2,3,4,5,6,7\n", "r.csv: line 2 has 7 columns;"},
             Case{"a,b,c,d,e,f\n1,2,x,4,5,6\n",
                  "r.csv: line 2, column 3 (oz): 'x' is not a finite"},
             Case{"1,2,3,4,5,y\n", "r.csv: line 1, column 6 (pz): 'y'"},
             Case{"1,2,3,4,5,6\na,b,c,d,e,f\n", "r.csv: line 2, column 1 (ox): 'a'"},
             Case{"1,2,3,4,,6\n", "r.csv: line 1, column 5 (py): ''"},
             Case{"1,2,3,nan,5,6\n", "r.csv: line 1, column 4 (px): 'nan'"},
             Case{"\n1,2,3,4,5,inf\n", "r.csv: line 2, column 6 (pz): 'inf'"},
             Case{"", "r.csv: holds no rays;"},
             Case{"ox,oy,oz,px,py,pz\n", "r.csv: holds no rays;"},
             Case{"hello\n", "r.csv: line 1 has 1 column;"},
         }) {
        const auto table = read(c.text);
        REQUIRE_MESSAGE(!table, c.text);
        CHECK(table.error().kind == wavefog::ErrorKind::data);
        CHECK_MESSAGE(table.error().message.starts_with(c.message), table.error().message);
    }
}
