// Bevy's physically based fragment shader, with normals from offsets and roughened lobes.

#import bevy_pbr::{
    forward_io::{FragmentOutput, VertexOutput},
    lighting,
    mesh_bindings::mesh,
    mesh_functions::{get_local_from_world, get_world_from_local, sign_determinant_model_3x3m},
    mesh_view_bindings::view,
    pbr_fragment::pbr_input_from_standard_material,
    pbr_functions::{alpha_discard, apply_pbr_lighting, calculate_tbn_mikktspace, main_pass_post_lighting_processing},
    pbr_types::{PbrInput, STANDARD_MATERIAL_FLAGS_DOUBLE_SIDED_BIT, STANDARD_MATERIAL_FLAGS_UNLIT_BIT},
}

struct Pyramid {
    offset_uv: mat3x3<f32>,
    roughness_uv: mat3x3<f32>,
    offset_scale: vec2<f32>,
    roughness_min: vec3<f32>,
    correction_factor: f32,
    roughness_max: vec3<f32>,
    main_direction: vec3<f32>,
}

@group(#{MATERIAL_BIND_GROUP}) @binding(100) var<uniform> pyramid: Pyramid;
@group(#{MATERIAL_BIND_GROUP}) @binding(101) var offset_texture: texture_2d<f32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(102) var offset_sampler: sampler;
@group(#{MATERIAL_BIND_GROUP}) @binding(103) var roughness_texture: texture_2d<f32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(104) var roughness_sampler: sampler;

// The roughness of the base lobe, its alphas along T and B, and the shares of the bumps in the squared alphas of the
// whole lobe.
var<private> base_roughness: f32;
var<private> base_alphas: vec2<f32>;
var<private> shares: vec2<f32>;
// The directions to the light and to the eye in the frame of the lobe: T, B and N.
var<private> to_light: vec3<f32>;
var<private> to_eye: vec3<f32>;

// Smith's term is that of facets that hide each other. Bumps of a map do not, so that each of them has the term of the
// base lobe. It replaces Bevy's terms, whose arguments lack these directions.
fn visibility() -> f32 {
    let l = to_light;
    let v = to_eye;
    // g is the normal of one bump, which stands for all bumps that reflect l to v.
    let h = normalize(l + v);
    let g = normalize(vec3(shares * shares * h.xy / max(h.z, 1e-4), 1.0));
    let t = normalize(vec3(1.0, 0.0, 0.0) - g.x * g);
    let b = cross(g, t);
    let light = vec3(base_alphas * vec2(dot(t, l), dot(b, l)), saturate(dot(g, l)));
    let eye = vec3(base_alphas * vec2(dot(t, v), dot(b, v)), saturate(dot(g, v)));
    let sides = max(light.z * length(eye) + eye.z * length(light), 1e-6);
    return 0.5 / sides * g.z * light.z / max(l.z, 1e-4);
}

// Returns the input of a light with the light between microfacets of the base lobe: bumps do not light each other.
fn with_base(input: ptr<function, lighting::LightingInput>) -> lighting::LightingInput {
    var base = *input;
    base.F_ab = lighting::F_AB(base_roughness, base.layers[lighting::LAYER_BASE].NdotV);
    return base;
}

#ifdef STANDARD_MATERIAL_ANISOTROPY
// Bevy squares alpha once more, to roughness^4, where KHR_materials_anisotropy has alpha_b = roughness^2.
override fn bevy_pbr::lighting::specular_anisotropy(
    input: ptr<function, lighting::LightingInput>,
    derived_input: ptr<function, lighting::DerivedLightingInput>,
    L: vec3<f32>,
    roughness: f32,
    specular_intensity: f32,
) -> vec3<f32> {
    var base = with_base(input);
    let to_lobe = transpose(mat3x3(base.Ta, base.Ba, base.layers[lighting::LAYER_BASE].N));
    to_light = to_lobe * L;
    to_eye = to_lobe * base.V;
    return lighting::specular_anisotropy(&base, derived_input, L, sqrt(roughness), specular_intensity);
}

override fn bevy_pbr::lighting::V_GGX_anisotropic(
    at: f32,
    ab: f32,
    NdotL: f32,
    NdotV: f32,
    BdotV: f32,
    TdotV: f32,
    TdotL: f32,
    BdotL: f32,
) -> f32 {
    return visibility();
}
#else
override fn bevy_pbr::lighting::specular(
    input: ptr<function, lighting::LightingInput>,
    derived_input: ptr<function, lighting::DerivedLightingInput>,
    roughness: f32,
    specular_intensity: f32,
) -> vec3<f32> {
    var base = with_base(input);
    let n = base.layers[lighting::LAYER_BASE].N;
    let h = (*derived_input).H;
    // Any axes do, since the lobe is isotropic.
    let t = normalize(cross(n, select(vec3(1.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0), abs(n.y) < 0.7)));
    let to_lobe = transpose(mat3x3(t, cross(n, t), n));
    to_eye = to_lobe * base.V;
    to_light = to_lobe * (2.0 * dot(base.V, h) * h - base.V);
    return lighting::specular(&base, derived_input, roughness, specular_intensity);
}

override fn bevy_pbr::lighting::V_SmithGGXCorrelated(roughness: f32, NdotV: f32, NdotL: f32) -> f32 {
    return visibility();
}
#endif

// The length of the mean of the unit normals of the bumps.
var<private> mean_normal: f32 = 1.0;

// Diffuse light of direct lights is the mean over the normals of the bumps.
override fn bevy_pbr::lighting::Fd_Burley(
    input: ptr<function, lighting::LightingInput>,
    derived_input: ptr<function, lighting::DerivedLightingInput>,
) -> f32 {
    return mean_normal * lighting::Fd_Burley(input, derived_input);
}

#ifdef VERTEX_TANGENTS
#ifdef VERTEX_UVS_A

// The frame of offsets and roughness, and the scale of the slopes in the map.
struct Frame {
    e1: vec3<f32>,
    e2: vec3<f32>,
    scale: vec2<f32>,
}

fn frame_at(in: VertexOutput, uv: vec2<f32>) -> Frame {
    let tbn = calculate_tbn_mikktspace(in.world_normal, in.world_tangent);
    var frame = Frame(normalize(tbn[0]), normalize(tbn[1]), vec2(1.0));
#ifdef ROUGHCAST_FRAME_MAIN
    // e1 = m x n, e2 = n x e1: the part of m along the surface. Where n is parallel to m, that part is 0.
    let n = normalize(in.world_normal);
    let m = (get_world_from_local(in.instance_index) * vec4(pyramid.main_direction, 0.0)).xyz;
    let along_surface = m - dot(m, n) * n;
    if length(along_surface) > 1e-4 * length(m) {
        frame.e2 = normalize(along_surface);
        frame.e1 = sign_determinant_model_3x3m(mesh[in.instance_index].flags) * cross(frame.e2, n);
    }
#endif
#ifdef ROUGHCAST_FRAME_NATURAL
    // |p_u| and |p_v|, in units of the mesh per repeat.
    let local_from_world = get_local_from_world(in.instance_index);
    let px = (local_from_world * vec4(dpdx(in.world_position.xyz), 0.0)).xyz;
    let py = (local_from_world * vec4(dpdy(in.world_position.xyz), 0.0)).xyz;
    let tx = dpdx(uv);
    let ty = dpdy(uv);
    let stretch = vec2(length(px * ty.y - py * tx.y), length(py * tx.x - px * ty.x));
    frame.scale = vec2(abs(tx.x * ty.y - ty.x * tx.y)) / max(stretch, vec2(1e-20));
#endif
    return frame;
}

// Tilts the normal: n' = n - f_u e1 - f_v e2.
fn tilt(input: ptr<function, PbrInput>, frame: Frame, uv: vec2<f32>, is_front: bool) {
    // Unit normals of offsets that are divided by their scale.
    var stored = 2.0 * textureSampleBias(offset_texture, offset_sampler, uv, view.mip_bias).xyz - 1.0;
#ifdef ROUGHCAST_REBUILT_Z
    stored.z = sqrt(max(1.0 - dot(stored.xy, stored.xy), 0.0));
#endif
    let f = -frame.scale * pyramid.offset_scale * stored.xy / max(stored.z, 1.0 / 32.0);
    let n = normalize(normalize((*input).world_normal) - f.x * frame.e1 - f.y * frame.e2);
    let is_double_sided = ((*input).material.flags & STANDARD_MATERIAL_FLAGS_DOUBLE_SIDED_BIT) != 0u;
    (*input).N = select(n, -n, is_double_sided && !is_front);
}

// Returns K (uu, uv, vv), the covariance of the slopes of the lost bumps.
fn covariance(frame: Frame, uv: vec2<f32>) -> vec3<f32> {
    let texel = textureSampleBias(roughness_texture, roughness_sampler, uv, view.mip_bias).rgb;
    let d = mix(pyramid.roughness_min, pyramid.roughness_max, texel);
#ifdef ROUGHCAST_FACTOR
    // K = D D^T with D = [[d1, d2], [0, d3]].
    let k = vec3(d.x * d.x + d.y * d.y, d.y * d.z, d.z * d.z);
#else
    let k = vec3(d.x * d.x, 0.0, d.x * d.x);
#endif
    return k * frame.scale.xxy * frame.scale.xyy;
}

// Roughens the base lobe: A' = A + 2 c K. The axes of the lobe follow the tilted normal, also if K is 0.
fn roughen(input: ptr<function, PbrInput>, frame: Frame, k: vec3<f32>) {
    // The slopes of the bumps have the variance c tr K.
    mean_normal = inverseSqrt(1.0 + pyramid.correction_factor * (k.x + k.z));
    let alpha = lighting::perceptualRoughnessToRoughness((*input).material.perceptual_roughness);
    let bumps = 2.0 * pyramid.correction_factor * k;
#ifdef STANDARD_MATERIAL_ANISOTROPY
    // The base lobe, in the frame of K.
    let strength = (*input).anisotropy_strength;
    let along = mix(alpha, 1.0, strength * strength);
    var axis = vec2(dot((*input).anisotropy_T, frame.e1), dot((*input).anisotropy_T, frame.e2));
    axis /= max(length(axis), 1e-6);
    let across = alpha * alpha;
    let base = vec3(across, 0.0, across) + (along * along - across) * axis.xxy * axis.xyy;
    let a = base + bumps;
    // Eigenvalues, and the axis of the larger one.
    let middle = 0.5 * (a.x + a.z);
    let difference = 0.5 * (a.x - a.z);
    let radius = length(vec2(difference, a.y));
    let major = min(middle + radius, 1.0);
    let minor = clamp(middle - radius, across, 1.0);
    var e = select(vec2(a.y, radius - difference), vec2(radius + difference, a.y), difference > 0.0);
    let size = length(e);
    e = select(axis, e / max(size, 1e-20), size > 1e-9);
    // The roughness and strength that give these alphas in KHR_materials_anisotropy.
    let alpha_t = sqrt(major);
    let alpha_b = sqrt(minor);
    (*input).material.perceptual_roughness = sqrt(alpha_b);
    (*input).anisotropy_strength = sqrt(saturate((alpha_t - alpha_b) / max(1.0 - alpha_b, 1e-6)));
    // Bevy keeps the axes in the surface. Lobes about tilted normals are then not normalised, and too bright.
    let t = e.x * frame.e1 + e.y * frame.e2;
    (*input).anisotropy_T = normalize(t - dot(t, (*input).N) * (*input).N);
    (*input).anisotropy_B = cross((*input).N, (*input).anisotropy_T);
    // Base lobe and bumps along the axes of the lobe.
    let square = vec3(e.x * e.x, 2.0 * e.x * e.y, e.y * e.y);
    let base_t = dot(base, square);
    let bumps_t = dot(bumps, square);
    let squares = max(vec2(base_t, base.x + base.z - base_t), vec2(across));
    let bump_squares = max(vec2(bumps_t, bumps.x + bumps.z - bumps_t), vec2(0.0));
    base_alphas = sqrt(squares);
    shares = bump_squares / (squares + bump_squares);
#else
    // Different scales of u and v make the lobe anisotropic. This shader has isotropic lobes only, so it takes the
    // mean.
    let mean_bumps = 0.5 * (bumps.x + bumps.z);
    let squared = alpha * alpha + mean_bumps;
    base_alphas = vec2(alpha);
    shares = vec2(mean_bumps / squared);
    (*input).material.perceptual_roughness = sqrt(sqrt(min(squared, 1.0)));
#endif
}

fn bumps(in: VertexOutput, is_front: bool, input: ptr<function, PbrInput>) {
    var uv = in.uv;
    var roughness_uv = in.uv;
#ifdef VERTEX_UVS_B
#ifdef ROUGHCAST_OFFSET_UV_B
    uv = in.uv_b;
#endif
#ifdef ROUGHCAST_ROUGHNESS_UV_B
    roughness_uv = in.uv_b;
#endif
#endif
    uv = (pyramid.offset_uv * vec3(uv, 1.0)).xy;
    roughness_uv = (pyramid.roughness_uv * vec3(roughness_uv, 1.0)).xy;
    let frame = frame_at(in, uv);
    tilt(input, frame, uv, is_front);
#ifdef ROUGHCAST_MODEL
    roughen(input, frame, covariance(frame, roughness_uv));
#else
    roughen(input, frame, vec3(0.0));
#endif
}

#endif  // VERTEX_UVS_A
#endif  // VERTEX_TANGENTS

@fragment
fn fragment(in: VertexOutput, @builtin(front_facing) is_front: bool) -> FragmentOutput {
    var input = pbr_input_from_standard_material(in, is_front);
    base_roughness = input.material.perceptual_roughness;
    base_alphas = vec2(lighting::perceptualRoughnessToRoughness(base_roughness));
#ifdef VERTEX_TANGENTS
#ifdef VERTEX_UVS_A
    bumps(in, is_front, &input);
#endif
#endif
    input.material.base_color = alpha_discard(input.material, input.material.base_color);
    var out: FragmentOutput;
    if (input.material.flags & STANDARD_MATERIAL_FLAGS_UNLIT_BIT) == 0u {
        out.color = apply_pbr_lighting(input);
    } else {
        out.color = input.material.base_color;
    }
    out.color = main_pass_post_lighting_processing(input, out.color);
    return out;
}
