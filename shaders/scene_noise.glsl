// Gradient noise with its derivative, for detail that a scene's maps do not hold.
// Inputs: positions in units of the lattice. Outputs: value about [-1,1] and d value / d position.

uint scene_hash(uvec3 cell) {
    uint h = cell.x * 0x8da6b343u + cell.y * 0xd8163841u + cell.z * 0xcb1ab31fu;
    h = (h ^ (h >> 15)) * 0x2c1b3c6du;
    h = (h ^ (h >> 12)) * 0x297a2d39u;
    return h ^ (h >> 15);
}

vec3 scene_lattice_gradient(ivec3 cell) {
    uint h = scene_hash(uvec3(cell));
    return vec3(float(h & 0x3ffu), float((h >> 10) & 0x3ffu), float((h >> 20) & 0x3ffu)) / 511.5 - 1.0;
}

// (value, gradient) of 3-D gradient noise with quintic interpolation.
vec4 scene_noise(vec3 p) {
    vec3 corner = floor(p);
    ivec3 i = ivec3(corner);
    vec3 w = p - corner;
    vec3 u = w * w * w * (w * (w * 6.0 - 15.0) + 10.0);
    vec3 du = 30.0 * w * w * (w * (w - 2.0) + 1.0);

    vec3 ga = scene_lattice_gradient(i);
    vec3 gb = scene_lattice_gradient(i + ivec3(1, 0, 0));
    vec3 gc = scene_lattice_gradient(i + ivec3(0, 1, 0));
    vec3 gd = scene_lattice_gradient(i + ivec3(1, 1, 0));
    vec3 ge = scene_lattice_gradient(i + ivec3(0, 0, 1));
    vec3 gf = scene_lattice_gradient(i + ivec3(1, 0, 1));
    vec3 gg = scene_lattice_gradient(i + ivec3(0, 1, 1));
    vec3 gh = scene_lattice_gradient(i + ivec3(1, 1, 1));
    float va = dot(ga, w);
    float vb = dot(gb, w - vec3(1, 0, 0));
    float vc = dot(gc, w - vec3(0, 1, 0));
    float vd = dot(gd, w - vec3(1, 1, 0));
    float ve = dot(ge, w - vec3(0, 0, 1));
    float vf = dot(gf, w - vec3(1, 0, 1));
    float vg = dot(gg, w - vec3(0, 1, 1));
    float vh = dot(gh, w - vec3(1, 1, 1));

    float kx = vb - va, ky = vc - va, kz = ve - va;
    float kxy = va - vb - vc + vd, kyz = va - vc - ve + vg, kzx = va - vb - ve + vf;
    float kxyz = -va + vb + vc - vd + ve - vf - vg + vh;
    float value = va + u.x * kx + u.y * ky + u.z * kz + u.x * u.y * kxy + u.y * u.z * kyz +
                  u.z * u.x * kzx + u.x * u.y * u.z * kxyz;
    vec3 gradient = ga + u.x * (gb - ga) + u.y * (gc - ga) + u.z * (ge - ga) +
                    u.x * u.y * (ga - gb - gc + gd) + u.y * u.z * (ga - gc - ge + gg) +
                    u.z * u.x * (ga - gb - ge + gf) +
                    u.x * u.y * u.z * (-ga + gb + gc - gd + ge - gf - gg + gh) +
                    du * (vec3(kx, ky, kz) + u.yzx * vec3(kxy, kyz, kzx) +
                          u.zxy * vec3(kzx, kxy, kyz) + u.yzx * u.zxy * kxyz);
    return vec4(value, gradient);
}

// Octaves of noise whose longest wave is `wavelength` metres. An octave fades out as its wave nears
// two `footprint`s (metres a pixel covers), so distant ground does not shimmer. Gradient per metre.
vec4 scene_fractal(vec3 metres, float wavelength, int octaves, float footprint) {
    vec4 sum = vec4(0);
    float frequency = 1.0 / wavelength, amplitude = 1.0;
    vec3 shift = vec3(0);
    for (int octave = 0; octave < octaves; ++octave) {
        float keep = 1.0 - smoothstep(0.2, 0.5, frequency * footprint);
        if (keep <= 0.0) break;
        vec4 noise = scene_noise(metres * frequency + shift);
        sum += amplitude * keep * vec4(noise.x, noise.yzw * frequency);
        frequency *= 2.03;
        amplitude *= 0.5;
        shift += vec3(17.3, 5.9, 31.7);
    }
    return sum;
}
