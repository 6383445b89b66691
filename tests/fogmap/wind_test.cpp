// Wind: where it takes fogs, exactly and at any time.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "fogmap/fog_support.h"
#include "fogmap/model_support.h"
#include "wavefog/fogmap/model_motion.h"
#include "wavefog/fogmap/reference.h"

using namespace wavefog;
using namespace wavefog::test;
using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

Wind changing() {
    Wind wind;
    wind.keys = {{-2, 3, 0}, {1, 1, -4}, {4, -2, 2}, {4.5, 6, 2}};
    return wind;
}

Vector3d ground(const Vector2d& v) {
    return {v.x(), 0, v.y()};
}

}  // namespace

TEST_CASE("wind: the offset is the velocity's integral from time 0") {
    const Wind wind = changing();
    CHECK(wind.offset(0).norm() == 0);
    CHECK(wind.velocity(-9) == Vector2d(3, 0));
    CHECK(wind.velocity(2.5) == Vector2d(-0.5, -1));
    CHECK(wind.velocity(99) == Vector2d(6, 2));
    for (const double end : {-7.0, -1.0, 0.3, 1.0, 2.0, 4.2, 4.5, 50.0}) {
        // Simpson's rule on each side of every key is exact for straight lines.
        Vector2d sum(0, 0);
        std::vector<double> places = {0, end};
        for (const auto& key : wind.keys)
            if ((key.seconds - 0) * (key.seconds - end) < 0) places.push_back(key.seconds);
        std::sort(places.begin(), places.end());
        for (std::size_t i = 0; i + 1 < places.size(); ++i) {
            const double a = places[i], b = places[i + 1];
            sum += (b - a) * wind.velocity((a + b) / 2);
        }
        if (end < 0) sum = -sum;
        CAPTURE(end);
        // A few roundings of values below 400.
        CHECK_LE((wind.offset(end) - sum).norm(), 1e-13);
    }
}

TEST_CASE("wind: 600 frames without drift") {
    // A frame is computed from its time alone; stepping in double drifts by rounding only.
    const Wind wind = changing();
    Vector2d stepped(0, 0);
    for (int frame = 0; frame < 600; ++frame) {
        const double t = frame / 24.0, next = (frame + 1) / 24.0;
        CHECK_LE((wind.offset(t) - stepped).norm(), 600 * 1e-13);
        // The closed form of one step: the mean velocity of its parts between keys.
        double at = t;
        for (const auto& key : wind.keys)
            if (key.seconds > at && key.seconds < next) {
                stepped += (key.seconds - at) * wind.velocity((at + key.seconds) / 2);
                at = key.seconds;
            }
        stepped += (next - at) * wind.velocity((at + next) / 2);
    }
}

TEST_CASE("wind: moving a model is looking from elsewhere, for every kind") {
    Random random(211);
    const auto models = random_models(random);
    const Vector3d metres(13.25, 0, -7.5);
    for (const FogModel& model : models) {
        const FogModel there = moved(model, metres);
        CAPTURE(kind_name(model));
        CHECK(validate(there).has_value());
        for (const auto& [o, p] : model_segments(random, 200)) {
            const double tau = optical_depth(there, o, p);
            CHECK_LE(std::abs(tau - optical_depth(model, o - metres, p - metres)),
                     1e-12 * (1 + tau));
            CHECK_LE(std::abs(extinction(there, o) - extinction(model, o - metres)), 1e-12);
        }
    }
    const auto all = models_at(models, {Wind(2, 0)}, 3);
    CHECK(std::get<Halfspace>(all[0]).point.x() == std::get<Halfspace>(models[0]).point.x() + 6);
    CHECK(std::get<Cosines>(all[7]).waves[0].phase == std::get<Cosines>(models[7]).waves[0].phase);
}

TEST_CASE("wind: 600 frames of every model, direct or step by step, from time 0 and from 1e6 s") {
    Random random(229);
    const auto models = random_models(random);
    const auto segments = model_segments(random, 100);
    Wind wind;
    wind.keys = {{0, 1, 0}, {5, -2, 3}, {20, 0.5, 0.7}};
    for (const double start : {0.0, 1e6})
        for (const FogModel& model : models) {
            FogModel stepped = models_at({model}, {wind}, start).front();
            for (int frame = 1; frame <= 600; ++frame) {
                const Vector2d step =
                    wind.offset(start + frame / 24.0) - wind.offset(start + (frame - 1) / 24.0);
                stepped = moved(stepped, ground(step));
            }
            const FogModel direct = models_at({model}, {wind}, start + 25).front();
            // Stepping rounds a place 600 times: of less than 100 m to 1e-14 m, of 1e6 m to 1e-10 m
            // (and each step, a difference of such places, to as much). Fog changes by less than
            // 0.1/m a metre, on rays of up to 140 m.
            const double rounding = start == 0 ? 1e-14 : 2e-10;
            const Vector3d there = std::holds_alternative<Potentials>(model)
                                       ? ground(wind.offset(start))
                                       : Vector3d(0, 0, 0);
            CAPTURE(kind_name(model));
            CAPTURE(start);
            for (const auto& [o, p] : segments)
                CHECK_LE(std::abs(optical_depth(stepped, there + o, there + p) -
                                  optical_depth(direct, there + o, there + p)),
                         600 * rounding * 0.1 * 140);
        }
}

TEST_CASE("wind: what repeats comes back after 1e6 s without a digit lost") {
    Random random(233);
    // 1e6 s at 7.25 m/s are 181250 periods of 40 m, or 0.6 of it 217500 periods of 20 m.
    const Separable table{0.03,
                          {random_table(random, 9, -17.3, 22.7, true), AxisTable{},
                           random_table(random, 33, -11.7, 28.3, true)},
                          Separable::Integral::exact};
    Polynomials waves;
    waves.terms.push_back({0.02,
                           {0.8, -1, 0, 0, 0, 1},
                           {0.6, 0, -0.8},
                           {1.7, 0, 3.1},
                           10,
                           Polynomials::Outside::repeat});
    for (const FogModel& model : {FogModel(table), FogModel(waves)})
        for (const Vector3d& part : {Vector3d(0, 0, 0), Vector3d(12.5, 0, -6.25)}) {
            const FogModel later = moved(model, Vector3d(7.25e6, 0, 0) + part);
            const FogModel near = moved(model, part);
            CAPTURE(kind_name(model));
            double worst = 0;
            for (const auto& [o, p] : model_segments(random, 200))
                worst = std::max(worst,
                                 std::abs(optical_depth(later, o, p) - optical_depth(near, o, p)));
            // 7.25e6 m times 0.6 is rounded to 1e-9 m; a table's metres are exact.
            CHECK_LE(worst, std::holds_alternative<Polynomials>(model) ? 2e-10 : 1e-13);
        }
    const FogModel later = moved(FogModel(table), {7.25e6, 0, 4e6});
    const Separable& moved_table = std::get<Separable>(later);
    CHECK(moved_table.axes[0].begin == table.axes[0].begin);
    CHECK(moved_table.axes[2].end == table.axes[2].end);
}

TEST_CASE("wind: whole periods of a repeated map change nothing, bit for bit") {
    Random random(223);
    Fog fog = random_fog(24, 16, {.degree = 1, .levels = 2, .boundary = Boundary::repeat}, random);
    fog.rect = {-60, -40, 60, 40};
    // 1e6 s of it are 62500 and 15625 periods.
    fog.wind = {7.5, -1.25};
    CHECK(wind_offset(fog.wind, fog.rect, Boundary::repeat, 1e6).norm() == 0);
    CHECK(wind_offset(fog.wind, fog.rect, Boundary::zero, 1e6) == Vector2d(7.5e6, -1.25e6));
    const Reference now(fog), later(fog, 1e6);
    for (const auto& [o, p] : model_segments(random, 100))
        CHECK(now.optical_depth(o, p) == later.optical_depth(o, p));
}

TEST_CASE("wind: after 1e6 s the reference sees the map where it should be") {
    Random random(227);
    for (const Boundary boundary : {Boundary::zero, Boundary::repeat}) {
        Fog fog = random_fog(24, 16, {.degree = 2, .levels = 1, .boundary = boundary}, random);
        fog.rect = {-60, -40, 60, 40};
        fog.wind = {7.3, -2.1};
        const Reference home(fog), later(fog, 1e6);
        const Vector3d far = ground(fog.wind.offset(1e6));
        for (const auto& [o, p] : model_segments(random, 100)) {
            // Positions of 7e6 m have steps of 1e-9 m; a hundred of them of fog of 1/m.
            const double error = later.optical_depth(o + far, p + far) - home.optical_depth(o, p);
            CHECK_LE(std::abs(error), 1e-6 * fog.extinction);
        }
    }
}

TEST_CASE("wind: what cannot be is named") {
    Wind wind = changing();
    wind.keys[2].seconds = 1;
    CHECK(wind.validate().error().message == "[2]: time is 1, after 1; times must ascend");
    wind = changing();
    wind.keys[1].z = std::numeric_limits<double>::quiet_NaN();
    CHECK(wind.validate().error().message.find("[1]: ") == 0);
}
