// Parts of wavefog bench: result files, errors of pictures, tables, README, chart programs.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "bench/accuracy.h"
#include "bench/advantage.h"
#include "bench/charts.h"
#include "bench/gnuplot.h"
#include "bench/output.h"
#include "bench/paper_tables.h"
#include "bench/plan.h"
#include "bench/provenance.h"
#include "bench/readme.h"
#include "bench/results.h"
#include "bench/scale.h"
#include "bench/table_text.h"
#include "bench/variant.h"
#include "gpu/gl_support.h"
#include "wavefog/fogmap/coarsen.h"
#include "wavefog/fogmap/image.h"

using namespace wavefog;
using namespace wavefog::cli;
using wavefog::test::TempDir;

namespace {

Row row(const std::string& method, double ms, double error) {
    Row r;
    r.scene = r.group = "hill";
    r.map = "a, \"b\".png";
    r.map_width = r.map_height = 64;
    r.basis = "linear";
    r.family = "2,2";
    r.method = method;
    r.width = 800;
    r.height = 600;
    r.ms_median = ms;
    r.fps = 1000 / ms;
    r.ratio_homogeneous = ms / 2;
    r.max_dT = error;
    return r;
}

Results some_results() {
    Results results;
    results.provenance = {{"preset", "chart"}, {"commit", "abc"}, {"cores", 2}};
    results.rows = {row("homogeneous", 2, 0.5), row("exact", 20, 1e-7), row("march:8", 6, 0.2),
                    row("march:64", 30, 1e-3)};
    results.cut = {"one"};
    results.skipped = {"two"};
    Figure figure;
    figure.id = "f";
    figure.title = "A title with _ and \"quotes\"";
    figure.x = {"x, m", true, 1, 10, 2};
    figure.curves = {{"a,b", "2,2", Curve::Style::dashed, {{1, 0.5}, {2, 0}}}};
    figure.levels = {{kVisibleError, "1/510"}};
    figure.notes = {{1, 0.5, "note", "2,2"}};
    results.figures = {figure};
    return results;
}

std::size_t count(const std::string& text, const std::string& what) {
    std::size_t n = 0;
    for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
    return n;
}

}  // namespace

TEST_CASE("bench: results survive the way through a file; what was not measured is null") {
    const TempDir folder;
    const Results results = some_results();
    const Facts json = to_json(results);
    CHECK(json["rows"][1]["max_dT"] == 1e-7);
    CHECK(json["rows"][1]["ms_p05"].is_null());
    Results infinite = results;
    infinite.rows[0].psnr = std::numeric_limits<double>::infinity();
    CHECK(to_json(infinite)["rows"][0]["psnr"].is_null());

    const auto file = folder.write("results.json", json.dump());
    const Result<Results> back = read_results(file);
    REQUIRE_MESSAGE(back.has_value(), (back ? "" : back.error().message));
    CHECK(to_json(*back) == json);
    CHECK(figures_csv(back->figures) == figures_csv(results.figures));
}

TEST_CASE("bench: files that are no results are named with what is wrong") {
    const TempDir folder;
    for (const char* text :
         {"", "[]", "{\"provenance\": {}}", "{\"provenance\": {}, \"rows\": [{}]}"}) {
        const auto results = read_results(folder.write("bad.json", text));
        REQUIRE(!results.has_value());
        CHECK(results.error().kind == ErrorKind::data);
        CHECK(results.error().message.find("bad.json") != std::string::npos);
    }
    CHECK(!read_results(folder / "none.json").has_value());
}

TEST_CASE("bench: the CSV has the promised columns first, and quotes commas") {
    const std::string csv = rows_csv(some_results().rows);
    CHECK(csv.rfind("scene,map,map_width,map_height,basis,family,levels,mu,method,width,height,"
                    "ms_median,ms_p05,ms_p95,fps,ratio_homogeneous,max_dT,p99_dT,rmse_tau,psnr,"
                    "ssim,bytes,bound_dT",
                    0) == 0);
    CHECK(csv.find("hill,\"a, \"\"b\"\".png\",64,64,linear,\"2,2\",0,1.0,exact,800,600,20.0,,,50.0,"
                   "10.0,1e-07,") != std::string::npos);
    CHECK(count(csv, "\n") == 5);
}

TEST_CASE("bench: errors of a picture that is right, and of one with a known error") {
    constexpr int width = 20, height = 16;
    Truth truth{width, height, std::vector<double>(width * height), {}};
    Image tau{width, height, 1, std::vector<float>(width * height)};
    Image scene{width, height, 4, std::vector<float>(4 * width * height, 0.2f)};
    for (std::size_t i = 0; i < truth.tau.size(); ++i) {
        tau.pixels[i] = float(i) / 64;
        truth.tau[i] = double(tau.pixels[i]);
    }
    const Eigen::Vector3d fog(0.8, 0.8, 0.8);
    const Accuracy right = measure_accuracy(truth, tau, scene, fog);
    CHECK(right.max_dT == 0);
    CHECK(right.rmse_tau == 0);
    CHECK(right.psnr == doctest::Approx(200));
    CHECK(right.ssim == doctest::Approx(1));

    // One pixel without its fog: T is 1 there. Only the largest error shows it among 320 pixels.
    tau.pixels[64] = 0;
    const Accuracy wrong = measure_accuracy(truth, tau, scene, fog);
    CHECK(wrong.max_dT == doctest::Approx(1 - std::exp(-1.0)));
    CHECK(wrong.p99_dT == 0);
    CHECK(wrong.rmse_tau == doctest::Approx(1 / std::sqrt(320.0)));
    const double difference = srgb_from_linear(0.8 - 0.6 * std::exp(-1.0)) - srgb_from_linear(0.2);
    CHECK(wrong.psnr ==
          doctest::Approx(-10 * std::log10(difference * difference / 320)).epsilon(1e-6));
    CHECK(wrong.ssim < 1);
}

TEST_CASE("bench: structural similarity by its formula") {
    // Two constant pictures have no structure: only the luminance term is left.
    const std::vector<double> a(30 * 20, 0.5), b(30 * 20, 0.7);
    CHECK(ssim(30, 20, a, b) ==
          doctest::Approx((2 * 0.5 * 0.7 + 1e-4) / (0.5 * 0.5 + 0.7 * 0.7 + 1e-4)));
    CHECK(ssim(30, 20, a, a) == doctest::Approx(1));
    // An inverted texture is anti-correlated.
    std::vector<double> texture(30 * 20), inverse(30 * 20);
    for (std::size_t i = 0; i < texture.size(); ++i) {
        texture[i] = i % 2 == 0 ? 0.3 : 0.7;
        inverse[i] = 1 - texture[i];
    }
    CHECK(ssim(30, 20, texture, inverse) < -0.9);
    CHECK(ssim(10, 10, texture, inverse) == 1);
}

TEST_CASE("bench: area averages keep the mean, at any ratio of sizes") {
    Grid<float> map(6, 9);
    for (int j = 0; j < 6; ++j)
        for (int i = 0; i < 9; ++i) map(j, i) = float(i * i + 3 * j);
    CHECK((area_average(map, 9, 6) - map).abs().maxCoeff() < 1e-5f);
    const Grid<float> thirds = area_average(map, 3, 2);
    CHECK(thirds(0, 0) == doctest::Approx(map.topLeftCorner(3, 3).mean()));
    CHECK(area_average(map, 4, 5).mean() == doctest::Approx(map.mean()));
}

TEST_CASE("bench: lists on the command line") {
    const auto methods = parse_methods("exact,march:8,paper:16:perimeter");
    REQUIRE(methods.has_value());
    CHECK(methods->size() == 3);
    CHECK((*methods)[1].samples == 8);
    for (const char* bad : {"", "exact,none", "reference", "march:0"}) {
        CAPTURE(bad);
        CHECK(!parse_methods(bad).has_value());
    }
    CHECK(parse_mus("1,0.5,0")->size() == 3);
    CHECK(!parse_mus("1,2").has_value());
    CHECK(parse_level_list("0,3")->back() == 3);
    CHECK(!parse_level_list("x").has_value());
}

TEST_CASE("bench: tables are aligned, and the same in Markdown") {
    Table table({"map", "μ = 1"});
    table.add({"16×16", "3.00"});
    table.add({"x", "12.0"});
    CHECK(table.text(false) == "map    μ = 1\n16×16   3.00\nx       12.0\n");
    CHECK(table.text(true) ==
          "| map   | μ = 1 |\n| ----- | ----: |\n| 16×16 |  3.00 |\n| x     |  12.0 |\n");
    CHECK(short_number(1234.6) == "1235");
    CHECK(short_number(9.999) == "10.0");
    CHECK(short_number({}) == "-");
    const std::string text = rows_text(some_results().rows, false);
    CHECK(text.find("1.0e-07") != std::string::npos);
    CHECK(text.find("march:64") != std::string::npos);
}

TEST_CASE("bench: the paper's tables show both figures relative to the same cell") {
    std::vector<Row> rows;
    const auto add = [&](int size, const char* basis, int levels, const char* method, double mu,
                         double fps) {
        Row r = row(method, 1000 / fps, 0);
        r.group = "paper tables";
        r.map_width = size;
        r.basis = basis;
        r.levels = levels;
        r.mu = mu;
        rows.push_back(r);
    };
    add(16, "haar", 0, "paper", 1, 20);
    add(64, "linear", 0, "paper", 1, 5);
    add(64, "linear", 0, "paper-scaling", 1, 8);
    add(64, "linear", 3, "paper-scaling", 0.4, 16);
    add(16, "linear", 2, "paper", 1, 2);
    add(16, "linear", 2, "paper-scaling", 1, 5);
    const std::string text = paper_tables_text(rows, true);
    CHECK(text.find("199 (1.00)") != std::string::npos);  // paper, table 1
    CHECK(text.find("45.0 (0.23)") != std::string::npos);
    CHECK(text.find("5.00 (0.25)") != std::string::npos);         // ours
    CHECK(text.find("76.0 (1.69)") != std::string::npos);         // paper, table 2
    CHECK(text.find("16.0 (3.20)") != std::string::npos);         // ours
    CHECK(text.find("47.0 → 99.0 (2.1×)") != std::string::npos);  // paper, table 3
    CHECK(text.find("2.00 → 5.00 (2.5×)") != std::string::npos);  // ours
}

TEST_CASE("bench: a README's regions are filled from the files they name, again and again") {
    const TempDir folder;
    folder.write("r.json", to_json(some_results()).dump());
    const std::string text = "before\n<!-- bench r.json -->\nold\n<!-- /bench -->\nafter\n";
    const auto filled = fill_readme(text, folder / "");
    REQUIRE_MESSAGE(filled.has_value(), (filled ? "" : filled.error().message));
    CHECK(filled->find("old") == std::string::npos);
    CHECK(filled->rfind("before\n<!-- bench r.json -->\n", 0) == 0);
    CHECK(filled->find(" march:64 |") != std::string::npos);
    CHECK(filled->find("commit `abc`") != std::string::npos);
    CHECK(filled->find("\n<!-- /bench -->\nafter\n") != std::string::npos);
    CHECK(*fill_readme(*filled, folder / "") == *filled);

    CHECK(*fill_readme("no region", "") == "no region");
    CHECK(!fill_readme("<!-- bench r.json -->", folder / "").has_value());
    CHECK(!fill_readme("<!-- bench none.json --><!-- /bench -->", folder / "").has_value());
}

TEST_CASE("bench: the chart of cost against error joins the best settings of each method") {
    Results results = some_results();
    results.rows.push_back(row("march:16", 40, 0.1));  // dearer and worse than march:64
    results.figures.clear();
    const auto figures = figures_of(results);
    REQUIRE(figures.size() == 1);
    const Figure& figure = figures.front();
    CHECK(figure.id == "error-hill");
    CHECK(figure.levels.front().y == kVisibleError);
    CHECK(figure.top_factor == 2);
    for (const Curve& curve : figure.curves)
        if (curve.key == "march")
            CHECK(curve.points.size() == (curve.style == Curve::Style::line ? 2 : 1));
    const std::string program = gnuplot_program(figure, "svg", "it's.svg");
    CHECK(count(program, "with linespoints") == 3);
    CHECK(program.find("set output \"it's.svg\"") != std::string::npos);
    CHECK(program.find("set logscale x2") != std::string::npos);
    CHECK(program.find("N = 64") != std::string::npos);
}

TEST_CASE("bench: ours against march and froxel at equal error") {
    // ratio_homogeneous is ms / 2.
    const std::vector<Row> rows = {row("radial", 3, 5e-4),     row("exact", 10, 5e-7),
                                   row("march:8", 6, 5e-2),    row("march:64", 40, 5e-4),
                                   row("froxel", 5, 0.09),     row("paper", 1, 1e-6),
                                   row("march:512", 300, 2e-5)};
    const std::string text = advantage_text(rows, true);
    // At 1e-1 froxel is theirs, 2.5 against 1.5; at 1e-3 march:64, 20 against 1.5.
    CHECK(text.find("| hill, 1e-01") != std::string::npos);
    CHECK(text.find("1.67 |") != std::string::npos);
    CHECK(text.find("13.3 |") != std::string::npos);
    CHECK(text.find("30.0 |") != std::string::npos);  // 1e-4: exact against march:512
    CHECK(text.find("none |") != std::string::npos);  // 1e-5: theirs do not reach it
    CHECK(text.find("paper") == std::string::npos);

    const Curve bar = five_times_ours(rows);
    REQUIRE(bar.points.size() == 3);  // radial, a step to exact's cost, exact
    CHECK(bar.points[0] == std::pair(7.5, 5e-4));
    CHECK(bar.points[1] == std::pair(25.0, 5e-4));
    CHECK(bar.points[2] == std::pair(25.0, 5e-7));
    CHECK(five_times_ours({row("march:8", 6, 5e-2)}).points.empty());
}

TEST_CASE("bench: a chart leaves out what a logarithmic axis cannot show, and means no markup") {
    const Figure figure = some_results().figures.front();
    const std::string program = gnuplot_program(figure, "pngcairo", "f.png");
    CHECK(program.find("{/:Bold A title with \\\\_ and \\\"quotes\\\"}") != std::string::npos);
    CHECK(program.find("1 0.5\nEOD") != std::string::npos);
    CHECK(program.find("2 0\n") == std::string::npos);
    Figure empty = figure;
    empty.curves.front().points.clear();
    CHECK(gnuplot_program(empty, "svg", "f.svg").find("plot NaN") != std::string::npos);
}

TEST_CASE("bench: data files are named with their SHA-256") {
    const TempDir folder;
    const auto file = folder.write("abc", "abc");
    CHECK(sha256_of(file) == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    CHECK(sha256_of(folder / "none").empty());
    const auto scene = folder.write("s.json", R"({"terrain": {"heightmap": "hill.png"},
        "fog": [{"image": "maps/a.png"}, {"file": "b.exr"}], "meshes": [{"file": "b.exr"}]})");
    const auto files = files_of_scene(scene);
    REQUIRE(files.size() == 4);
    CHECK(files[0] == scene);
    CHECK(files[3] == folder / "maps/a.png");
    CHECK(is_software("llvmpipe (LLVM 15.0.6, 256 bits)"));
    CHECK(!is_software("NVIDIA H200"));
}

TEST_CASE("bench scale: maps of any size, mirrored where they have too few pixels") {
    Grid<float> map(2, 3);
    map << 1, 2, 3, 4, 5, 6;
    const Grid<float> large = sized_map(map, 6);
    CHECK(large.rows() == 6);
    CHECK(large.cols() == 6);
    const float first[] = {1, 2, 3, 3, 2, 1}, third[] = {4, 5, 6, 6, 5, 4};
    for (int i = 0; i < 6; ++i) {
        CHECK(large(0, i) == first[i]);
        CHECK(large(2, i) == third[i]);  // mirrored: rows 0 1 1 0 0 1
        CHECK(large(3, i) == first[i]);
    }
    // A smaller map keeps the mean.
    const Grid<float> small = sized_map(large, 3);
    CHECK(small.rows() == 3);
    CHECK(small.mean() == doctest::Approx(3.5));
}

TEST_CASE("bench scale: five cameras a scene, and the worst error of all in the table") {
    BenchScene scene{"hill", {"a.png"}, {}, {}};
    scene.scene.camera.eye = {0, 10, 50};
    scene.scene.camera.target = {0, 5, 0};
    const auto all = scale_scenes({scene, scene});
    REQUIRE(all.size() == 10);
    CHECK(all[0].name == "hill");
    CHECK(all[0].scene.camera.eye == scene.scene.camera.eye);
    for (std::size_t i = 0; i < 5; ++i) {
        const Camera& camera = all[i].scene.camera;
        const Eigen::Vector3d view = (camera.target - camera.eye).normalized();
        CHECK(view.cross(camera.up.normalized()).norm() > 0.1);  // a camera that can be drawn
        CHECK((camera.target - camera.eye).norm() > 1);
    }
    const Camera& down = all[2].scene.camera;
    CHECK((down.target - down.eye).normalized().y() == doctest::Approx(-1));

    std::vector<Row> rows = {row("exact", 20, 1e-7), row("exact", 30, 3e-7),
                             row("exact", 10, 2e-7)};
    rows[1].scene = "hill, down";
    const std::string text = scale_table_text(rows, false);
    CHECK(text.find("800 wide, 64², exact") != std::string::npos);
    CHECK(text.find("10.0") != std::string::npos);     // the median of 10, 15 and 5
    CHECK(text.find("15.0") != std::string::npos);     // the worst
    CHECK(text.find("3.0e-07") != std::string::npos);  // the worst error
    rows.push_back(row("exact", 20, 1e-7));
    rows.back().basis = "haar";
    rows.back().p99_dT = 4e-8;
    const std::string summary = scale_summary_text(rows, false);
    CHECK(summary.find("800 wide, hill, 64²") != std::string::npos);
    CHECK(summary.find("800 wide, hill, Haar, 64²") != std::string::npos);
    CHECK(summary.find("1.0e-07 (4.0e-08)") != std::string::npos);
    CHECK(summary.find("10.0 (15.0)") != std::string::npos);
    CHECK(summary.find("3.0e-07") != std::string::npos);
}

TEST_CASE(
    "bench scale: a picture in a map's place, both picture sizes, Haar from the first camera") {
    const TempDir folder;
    BenchScene scene{"hill", {"a.png"}, {}, {}};
    scene.scene.camera.eye = {0, 10, 50};
    Result<Fog> fog = make_fog(Grid<float>::Ones(8, 8), {.degree = 2, .levels = 2});
    REQUIRE(fog);
    fog->extinction = 0.3;
    scene.scene.fogs = {*fog};
    Image picture{10, 6, 1, std::vector<float>(60)};
    for (std::size_t i = 0; i < 60; ++i) picture.pixels[i] = float(i) / 64;
    REQUIRE(write_image(folder / "other.tif", picture));
    REQUIRE(put_map(scene, folder / "other.tif"));
    CHECK(scene.map_names.front() == "other.tif");
    const Fog& put = scene.scene.fogs.front();
    CHECK(put.degree() == 2);
    CHECK(put.extinction == 0.3);
    const Grid<float> map = map_of(put);
    REQUIRE(map.rows() == 6);
    REQUIRE(map.cols() == 10);
    for (int j = 0; j < 6; ++j)
        for (int i = 0; i < 10; ++i)  // the transform there and back in float
            CHECK(std::abs(map(j, i) - picture.at(i, j, 0)) < 1e-5f);
    CHECK(!put_map(scene, folder / "none.png"));

    const auto groups = plan_scale(scale_scenes({scene}), {80, 60}, {homogeneous_method()}, {1});
    REQUIRE(groups);
    // Of each map size: five cameras at two picture sizes, and Haar.
    REQUIRE(groups->size() == 4 * 11);
    CHECK(std::count_if(groups->begin(), groups->end(), [](const Group& group) {
              return group.variants.front()->basis == "haar";
          }) == 4);
}

TEST_CASE("bench: the truth of a pixel larger than cells is its mean, of others its middle") {
    Grid<float> map(256, 256);
    for (int j = 0; j < 256; ++j)
        for (int i = 0; i < 256; ++i) map(j, i) = float((i + j) % 2);
    Result<Fog> fog = make_fog(map, {.degree = 0, .levels = 0});
    REQUIRE(fog);
    fog->rect = {-128, -128, 128, 128};
    fog->extinction = 0.02;
    Camera camera;
    camera.eye = {3, 6, 100};
    camera.target = {0, 0, 40};
    constexpr int width = 24, height = 16, fine = 4;
    const double depth = camera_matrices(camera, width, height).sky_depth;
    const Image sky{width, height, 1, std::vector<float>(width * height, float(depth))};
    const Image fine_sky{fine * width, fine * height, 1,
                         std::vector<float>(fine * fine * width * height, float(depth))};
    const Truth truth = compute_truth({*fog}, {}, camera, sky, 1, true);
    const Truth parts = compute_truth({*fog}, {}, camera, fine_sky);
    const Truth plain = compute_truth({*fog}, {}, camera, sky);
    CHECK(plain.mean_T.empty());
    CHECK(plain.tau == truth.tau);
    REQUIRE(truth.mean_T.size() == truth.tau.size());
    int means = 0;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const std::size_t at = std::size_t(y * width + x);
            // The same sixteen rays, drawn as pixels of a picture four times as large.
            double sum = 0;
            for (int j = 0; j < fine; ++j)
                for (int i = 0; i < fine; ++i)
                    sum += std::exp(
                        -parts.tau[std::size_t((fine * y + j) * fine * width + fine * x + i)]);
            CHECK(truth.mean_T[at] == doctest::Approx(sum / (fine * fine)).epsilon(1e-9));
            if (truth.mean_T[at] != std::exp(-truth.tau[at])) ++means;
        }
    CHECK(means > width * height / 2);
    // Cells of 3.2 km, pixels below 1 km.
    Result<Fog> large = make_fog(map.topLeftCorner(8, 8), {.degree = 0, .levels = 0});
    REQUIRE(large);
    large->rect = {-12800, -12800, 12800, 12800};
    large->extinction = 1e-4;
    const Truth coarse = compute_truth({*large}, {}, camera, sky, 1, true);
    for (std::size_t i = 0; i < coarse.tau.size(); ++i)
        CHECK(coarse.mean_T[i] == std::exp(-coarse.tau[i]));
}

TEST_CASE("bench: errors may be measured in a part of the pixels") {
    Image image{5, 3, 2, {}};
    for (int i = 0; i < 30; ++i) image.pixels.push_back(float(i));
    const Image sparse = every_nth(image, 2);
    CHECK(sparse.width == 3);
    CHECK(sparse.height == 2);
    CHECK(sparse.at(2, 1, 1) == image.at(4, 2, 1));
    CHECK(every_nth(image, 1).pixels == image.pixels);
}
