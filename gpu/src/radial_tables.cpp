#include "radial_tables.h"

#include <algorithm>

#include "wavefog/gpu/pixel_rays.h"

namespace wavefog {
namespace {

RadialView radial_view_of(const FogView& view) {
    return radial_view(camera_matrices(view.camera, view.width, view.height), view.camera,
                       view.width, view.height);
}

}  // namespace

Result<RadialTables> RadialTables::create(const Gl& gl, std::vector<RadialFog> fogs,
                                          const Method& method) {
    RadialTables made(gl, std::move(fogs), method);
    for (const RadialFog& fog : made.fogs_) {
        auto fill = RadialFill::create(gl, *fog.facts, radial_shape(*fog.facts, method));
        if (!fill) return tl::unexpected(fill.error());
        made.fillers_.push_back(std::move(*fill));
    }
    if (auto done = made.set_views({}); !done) return tl::unexpected(done.error());
    return made;
}

Result<void> RadialTables::make_tables(Eye& eye) const {
    GLint largest = 0;
    gl_->GetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
    const int sharing = std::max(static_cast<int>(eye.views.size()), 1);
    for (std::size_t i = 0; i < fogs_.size(); ++i) {
        const RadialShape shape = radial_shape(*fogs_[i].facts, method_, sharing, largest);
        if (i < eye.tables.size() && eye.tables[i].shape() == shape) continue;
        auto table = RadialTable::create(*gl_, fillers_[i], shape, method_);
        if (!table) return tl::unexpected(table.error());
        if (i < eye.tables.size())
            eye.tables[i] = std::move(*table);
        else
            eye.tables.push_back(std::move(*table));
    }
    return {};
}

Result<void> RadialTables::set_views(const std::vector<FogView>& views) {
    std::vector<Eye> eyes;
    for (const FogView& view : views) {
        const Camera& camera = view.camera;
        if (camera.projection == Camera::Projection::orthographic) continue;
        auto eye = std::find_if(eyes.begin(), eyes.end(),
                                [&](const Eye& one) { return one.at == camera.eye; });
        if (eye == eyes.end()) {
            eye = eyes.emplace(eyes.end());
            eye->at = camera.eye;
        }
        eye->views.push_back(radial_view_of(view));
        eye->limit = std::max(eye->limit, sky_limit(camera));
    }
    if (eyes.empty()) eyes.emplace_back();
    for (std::size_t i = 0; i < eyes.size(); ++i) {
        if (!eyes[i].views.empty()) eyes[i].all = radial_union(eyes[i].views);
        if (i < eyes_.size()) eyes[i].tables = std::move(eyes_[i].tables);
        if (auto made = make_tables(eyes[i]); !made) {
            for (std::size_t j = 0; j <= i && j < eyes_.size(); ++j)
                eyes_[j].tables = std::move(eyes[j].tables);
            return made;
        }
    }
    eyes_ = std::move(eyes);
    return {};
}

const std::vector<RadialTable>& RadialTables::update(const FogView& view, double seconds) {
    const Camera& camera = view.camera;
    RadialView seen = radial_view_of(view);
    double limit = sky_limit(camera);
    Eye* eye = &eyes_.front();
    for (Eye& one : eyes_)
        if (one.at == camera.eye && limit <= one.limit &&
            std::find(one.views.begin(), one.views.end(), seen) != one.views.end()) {
            eye = &one;
            seen = one.all;
            limit = one.limit;
            break;
        }
    for (std::size_t i = 0; i < fogs_.size(); ++i) {
        const FogFacts& fog = *fogs_[i].facts;
        RadialTable& table = eye->tables[i];
        fills_ += table.update(fillers_[i], fog_block(fog, camera.eye, method_.mu, seconds, limit),
                               radial_block(fog, camera.eye, seen, seconds, limit, table.shape()),
                               fogs_[i].cells);
    }
    return eye->tables;
}

void RadialTables::forget() {
    for (Eye& eye : eyes_)
        for (RadialTable& table : eye.tables) table.forget();
}

bool RadialTables::layered(std::size_t fog) const {
    return eyes_.front().tables[fog].shape().layers > 1;
}

std::size_t RadialTables::bytes() const {
    std::size_t sum = 0;
    for (const RadialFill& filler : fillers_) sum += filler.bytes();
    for (const Eye& eye : eyes_)
        for (const RadialTable& table : eye.tables) sum += table.shape().bytes();
    return sum;
}

}  // namespace wavefog
