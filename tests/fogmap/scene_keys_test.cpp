// Every key of every fog, with every kind of bad value: the message names it.
#include <doctest/doctest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "fogmap/model_support.h"
#include "support/temp_dir.h"
#include "wavefog/fogmap/scene.h"

using namespace wavefog;
using namespace wavefog::test;
using nlohmann::json;

namespace {

const char* const kFogs[] = {
    R"({"model": "halfspace", "normal": [0, 1, 0], "point": [0, 3, 0], "extinction": 0.1,
        "gradient": 0.2, "wind": [1, 2], "channels": [1, 0.5, 0.25]})",
    R"({"model": "halfspace", "normal": [0, 1, 0], "point": [0, 3, 0], "extinction": 0.1,
        "fraction": "linear", "start": 5})",
    R"({"model": "layers", "profile": "ramp", "points": [[0, 0.1], [4, 0.2], [6, 0.1]]})",
    R"({"model": "layers", "profile": "exponential", "extinction": 0.1, "base": 2, "scale": 3})",
    R"({"model": "layers", "profile": "depth", "surface": 2, "gradient": 0.1})",
    R"({"model": "layers", "profile": "table", "extinction": 0.1,
        "y": {"values": [1, 2, 1], "begin": 0, "end": 9, "outside": "repeat"}})",
    R"({"model": "cosines", "extinction": 0.5, "waves": [{"extinction": 0.1,
        "direction": [1, 2, 3], "frequency": 0.3, "phase": 1}]})",
    R"({"model": "polynomials", "polynomials": [{"extinction": 0.1, "coefficients": [2, 0, 1],
        "direction": [1, 1, 1], "centre": [1, 2, 3], "half_width": 4, "outside": "repeat"}]})",
    R"({"model": "potentials", "extinction": 0.5, "objects": [
        {"point": [1, 2, 3], "extinction": 0.1, "reach": 2},
        {"line": [[1, 2, 3], [4, 5, 6]], "extinction": 0.1, "reach": 2},
        {"sphere": [1, 2, 3], "radius": 2, "extinction": 0.1, "reach": 2}]})",
    R"({"model": "separable", "extinction": 0.1, "integral": "published",
        "x": {"noise": {"seed": 4, "features": 5, "octaves": 2, "gain": 0.5}, "begin": 1, "end": 9},
        "y": {"exponential": 8, "begin": 3}, "z": {"cosine": 0.5, "begin": 1, "end": 40}})",
    R"({"model": "particles", "source": "smoke", "position": [1, 2, 3], "area": 1,
        "direction": [0, 1, 0], "spread_deg": 20, "speed": 1, "rate": 10, "life": [8, 16],
        "step": 0.1, "radius": [1, 2], "opacity": 0.5, "lift": 0.1, "drag": 0.2,
        "wind": [[0, 1, 2], [3, 4, 5]], "seed": 7, "channels": [1, 0.5, 0.25]})",
    R"({"model": "wavelet", "image": "map.pgm", "channel": "Y", "basis": "linear",
        "family": "2,2", "form": "wavelet", "levels": 1, "rect": [1, 2, 30, 40],
        "extinction": 0.1, "height": {"profile": "exponential", "base": 1, "scale": 2},
        "wind": [1, 2], "wrap": "zero", "sanitize": false, "channels": [1, 1, 0.5]})",
    R"({"images": [{"time": 1, "image": "map.pgm"}, {"time": 2, "image": "map.pgm"}],
        "rect": [1, 2, 30, 40], "extinction": 0.1,
        "height": {"profile": "slab", "bottom": 1, "top": 2}})"};

/// May the number at this place be below 0? Places, directions, phases and winds may; and a
/// share of what is added, as long as the sum is not negative.
bool any_number(const std::string& key, const json::json_pointer& at) {
    static const std::set<std::string> places = {
        "normal",    "point", "base",   "surface", "begin",  "end",    "direction",
        "frequency", "phase", "centre", "line",    "sphere", "bottom", "top",
        "position",  "lift",  "wind",   "time",    "rect",   "cosine", "height"};
    // A ramp's points are [y, extinction].
    return places.contains(key) || key == "coefficients" || (key == "points" && at.back() == "0");
}

struct Sweep {
    const TempDir& dir;
    int refused = 0, taken = 0;

    /// "" if it loads.
    std::string complaint(const json& fog) {
        write_bytes(
            dir / "scene.json",
            json{{"camera", {{"eye", {0, 2, 0}}, {"target", {0, 2, -1}}}}, {"fog", {fog}}}.dump());
        const auto scene = load_scene(dir / "scene.json");
        return scene ? "" : scene.error().message;
    }

    void check(const json& whole, const json::json_pointer& at, const std::string& key,
               const json& value, bool may_load) {
        json changed = whole;
        changed[at] = value;
        const std::string message = complaint(changed);
        CAPTURE(whole.dump());
        CAPTURE(at.to_string());
        CAPTURE(value.dump());
        CAPTURE(message);
        (message.empty() ? taken : refused) += 1;
        if (message.empty()) {
            CHECK(may_load);
            return;
        }
        CHECK(message.find("scene.json: fog[0]") != std::string::npos);
        CHECK(message.find(key) != std::string::npos);
    }

    /// Every value under `at`; `key` is the last name on the way.
    void visit(const json& whole, const json::json_pointer& at, const std::string& key) {
        const json& here = whole[at];
        const std::string model = whole.value("model", "wavelet");
        for (const json& wrong : {json(nullptr), json(true), json("no"), json::object(),
                                  json::array(), json(1.5), json::array({json::object()})}) {
            if (wrong.type() == here.type() && !here.is_array() && !here.is_string()) continue;
            if (wrong.is_number() && here.is_number()) continue;
            check(whole, at, key, wrong, false);
        }
        if (here.is_number()) {
            const bool share = key == "extinction" && (model == "potentials" || model == "cosines");
            check(whole, at, key, -1e-3, any_number(key, at) || share);
            check(whole, at, key, -1e9, any_number(key, at));
            // 0 leaves no fog, or no period: what may not be 0 is named.
            check(whole, at, key, 0,
                  !(key == "scale" || key == "reach" || key == "radius" || key == "half_width" ||
                    key == "rate" || key == "step" || key == "life" || key == "features" ||
                    key == "octaves" || key == "opacity" || key == "exponential"));
        }
        if (here.is_array()) {
            json fewer = here, more = here;
            if (!fewer.empty()) fewer.erase(fewer.size() - 1);
            more.push_back(here.empty() ? json(1) : here.back());
            const bool list = key == "points" || key == "values" || key == "coefficients" ||
                              key == "waves" || key == "polynomials" || key == "objects" ||
                              key == "images" || key == "wind";
            check(whole, at, key, fewer, list);
            check(whole, at, key, more, list);
        }
        if (here.is_object()) {
            json unknown = here;
            unknown["colour_of_noise"] = 1;
            check(whole, at, "colour_of_noise", unknown, false);
            for (const auto& [name, value] : here.items()) {
                json without = here;
                without.erase(name);
                const json::json_pointer deeper = at / name;
                check(whole, at, name, without, true);
                visit(whole, deeper, name);
            }
        } else if (here.is_array()) {
            for (std::size_t i = 0; i < here.size(); ++i) visit(whole, at / i, key);
        }
    }
};

}  // namespace

TEST_CASE("scene keys: a bad value of any key of any fog is refused with the key's name") {
    const TempDir dir;
    write_bytes(dir / "map.pgm", "P2 4 4 255\n255 0 128 64 255 0 128 64 255 0 128 64 9 9 9 9\n");
    Sweep sweep{dir};
    for (const char* text : kFogs) {
        const json fog = json::parse(text);
        REQUIRE_MESSAGE(sweep.complaint(fog).empty(), sweep.complaint(fog));
        for (const auto& [name, value] : fog.items())
            if (name != "model") sweep.visit(fog, json::json_pointer("/" + name), name);
        for (const auto& wrong : {json("smog"), json(3), json(nullptr)}) {
            if (!fog.contains("model")) continue;
            sweep.check(fog, json::json_pointer("/model"), "model", wrong, false);
        }
    }
    MESSAGE(sweep.refused, " bad values refused, ", sweep.taken, " changed values taken");
    CHECK(sweep.refused > 1000);
}

TEST_CASE("scene keys: NaN, infinity and overflow are refused by the library, by field") {
    Random random(907);
    const double bad[] = {std::numeric_limits<double>::quiet_NaN(),
                          std::numeric_limits<double>::infinity(),
                          -std::numeric_limits<double>::infinity()};
    const auto named = [&](const auto& model, double& field, const char* key) {
        const double good = field;
        for (const double value : bad) {
            field = value;
            const auto ok = validate(FogModel(model));
            CAPTURE(std::string(key));
            REQUIRE_FALSE(ok.has_value());
            CHECK_MESSAGE(ok.error().message.find(key) != std::string::npos, ok.error().message);
        }
        field = good;
    };
    const auto sweep = [&](auto& model,
                           std::initializer_list<std::pair<double*, const char*>> fields) {
        for (const auto& [field, key] : fields) named(model, *field, key);
    };
    Halfspace plane{{0, 1, 0}, {1, 2, 3}, 0.1, 0.2, Halfspace::Fraction::linear, 4};
    sweep(plane, {{&plane.normal.x(), "normal"},
                  {&plane.point.z(), "point"},
                  {&plane.extinction, "extinction"},
                  {&plane.gradient, "gradient"},
                  {&plane.start, "start"}});
    Ramp ramp{{{0, 0.1}, {1, 0.2}}};
    sweep(ramp, {{&ramp.points[0].y, "points[0]"},
                 {&ramp.points[1].y, "points[1]"},
                 {&ramp.points[1].extinction, "points[1]: extinction"}});
    ExponentialLayer layer{0.1, 1, 2};
    sweep(layer,
          {{&layer.extinction, "extinction"}, {&layer.base, "base"}, {&layer.scale, "scale"}});
    Cosines cosines = random_cosines(random);
    auto& wave = cosines.waves[1];
    sweep(cosines, {{&cosines.extinction, "extinction"},
                    {&wave.extinction, "waves[1].extinction"},
                    {&wave.direction.y(), "waves[1].direction"},
                    {&wave.frequency, "waves[1].frequency"},
                    {&wave.phase, "waves[1].phase"}});
    Polynomials polynomials = random_polynomials(random, {0, 0, 0});
    auto& term = polynomials.terms[2];
    sweep(polynomials, {{&term.extinction, "polynomials[2].extinction"},
                        {&term.coefficients[1], "polynomials[2].coefficients"},
                        {&term.direction.x(), "polynomials[2].direction"},
                        {&term.centre.x(), "polynomials[2].centre"},
                        {&term.half_width, "polynomials[2].half_width"}});
    Potentials potentials = random_potentials(random, {0, 0, 0});
    auto &line = potentials.objects[1], &sphere = potentials.objects[2];
    sweep(potentials, {{&potentials.extinction, "extinction"},
                       {&line.from.x(), "objects[1].line"},
                       {&line.to.y(), "objects[1].line"},
                       {&line.reach, "objects[1].reach"},
                       {&sphere.radius, "objects[2].radius"},
                       {&sphere.extinction, "objects[2].extinction"}});
    Separable separable = random_separable(random, {0, 0, 0}, true);
    sweep(separable, {{&separable.extinction, "extinction"},
                      {&separable.axes[0].begin, "x.begin"},
                      {&separable.axes[2].end, "z.end"},
                      {&separable.axes[1].values[3], "y.values[3]"}});

    ParticleSource source;
    for (const auto& [field, key] : {std::pair{&source.position.x(), "position"},
                                     {&source.area, "area"},
                                     {&source.direction.y(), "direction"},
                                     {&source.spread, "spread_deg"},
                                     {&source.speed, "speed"},
                                     {&source.rate, "rate"},
                                     {&source.step, "step"},
                                     {&source.radius[0], "radius[0]"},
                                     {&source.radius[1], "radius[1]"},
                                     {&source.opacity, "opacity"},
                                     {&source.lift, "lift"},
                                     {&source.drag, "drag"}}) {
        const double good = *field;
        for (const double value : bad) {
            *field = value;
            const auto ok = source.validate();
            CAPTURE(std::string(key));
            REQUIRE_FALSE(ok.has_value());
            CHECK_MESSAGE(ok.error().message.find(key) == 0, ok.error().message);
        }
        *field = good;
    }
    source.wind.keys = {{0, bad[0], 0}};
    CHECK(source.validate().error().message.find("wind") == 0);
}
