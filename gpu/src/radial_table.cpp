#include "radial_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

namespace wavefog {

Result<RadialTable> RadialTable::create(const Gl& gl, const RadialFill& fill,
                                        const RadialShape& shape, const Method& method) {
    GLint largest = 0;
    gl.GetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
    if (std::max(shape.columns, shape.rows * shape.layers) > largest)
        return data_error(
            fmt::format("{}: this context's textures have at most {} texels a side; "
                        "use a smaller table",
                        method.name(), largest));
    RadialTable table;
    table.shape_ = shape;
    table.table_ = fill.make_table(shape);
    if (const GLenum error = gl.GetError(); error != GL_NO_ERROR)
        return data_error(fmt::format(
            "{}: the context refused a table of {} bytes (GL error 0x{:x}); use a smaller one",
            method.name(), shape.bytes(), error));
    return table;
}

bool RadialTable::update(RadialFill& fill, const shader::FogBlock& fog,
                         const shader::RadialBlock& radial, GLuint cells) {
    // Every member of the blocks is a float or an int, without gaps.
    if (filled_ && std::memcmp(&fog, &fog_, sizeof(fog)) == 0 &&
        std::memcmp(&radial, &radial_, sizeof(radial)) == 0)
        return false;
    filled_ = true;
    fog_ = fog;
    radial_ = radial;
    fill.fill(table_.name(), shape_, fog, radial, cells);
    return true;
}

}  // namespace wavefog
