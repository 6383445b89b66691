// Uses each of the three libraries once, through installed headers alone.
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "wavefog/fogmap/reference.h"
#include "wavefog/gpu/context.h"
#include "wavefog/gpu/fog_pass.h"
#include "wavefog/wavelet/decomposition.h"

int main() {
    using namespace wavefog;
    const Grid<float> map = Grid<float>::Constant(8, 8, 0.5f);
    const auto d = decompose(map, default_family(1, Form::wavelet), 2);
    if (!d || d->levels() != 2) return std::puts("wavelet: no decomposition"), 1;

    FogOptions options;
    options.boundary = Boundary::repeat;
    const auto fog = make_fog(map, options);
    if (!fog) return std::printf("fogmap: %s\n", fog.error().message.c_str()), 1;
    const double tau = Reference(*fog).optical_depth({0, 0, 0}, {3, 0, 4});
    const auto shader = ShaderOnCpu::create(*fog, Method{});
    if (!shader) return std::printf("gpu: %s\n", shader.error().message.c_str()), 1;
    const double from_shader = shader->optical_depth({0, 0, 0}, {3, 0, 4});
    std::printf("optical depth %.9g, by the shader's code %.9g\n", tau, from_shader);
    if (std::abs(tau - 2.5) > 1e-12 || std::abs(from_shader - 2.5) > 1e-5) return 1;

    const auto context = create_context();
    if (!context) return std::printf("gpu: %s\n", context.error().message.c_str()), 1;
    std::printf("%s\n", (*context)->renderer().c_str());
    const auto textures = FogTextures::create((*context)->gl(), *fog);
    if (!textures) return std::printf("gpu: %s\n", textures.error().message.c_str()), 1;

    if (!std::filesystem::exists(WAVEFOG_SHADERS "/fog_pass.frag"))
        return std::puts("no shaders"), 1;
    return 0;
}
