"""GLSL's words: identifiers that are legal from GLSL 3.30 to 4.60 and in GLSL ES 3.00, numbers and type names."""

import math
import re
import struct
from collections.abc import Iterable
from functools import lru_cache

from sdfc.diagnostics import InternalError
from sdfc.field.operations import Type

# Keywords and words reserved for the future: GLSL 4.60 section 3.6 and GLSL ES 3.20 section 3.7.
_KEYWORDS = """
active asm atomic_uint attribute bool break buffer bvec2 bvec3 bvec4 case cast centroid class coherent common const
continue default discard dmat2 dmat2x2 dmat2x3 dmat2x4 dmat3 dmat3x2 dmat3x3 dmat3x4 dmat4 dmat4x2 dmat4x3 dmat4x4 do
double dvec2 dvec3 dvec4 else enum extern external false filter fixed flat float for fvec2 fvec3 fvec4 goto half
highp hvec2 hvec3 hvec4 if iimage1D iimage1DArray iimage2D iimage2DArray iimage2DMS iimage2DMSArray iimage2DRect
iimage3D iimageBuffer iimageCube iimageCubeArray image1D image1DArray image2D image2DArray image2DMS image2DMSArray
image2DRect image3D imageBuffer imageCube imageCubeArray in inline inout input int interface invariant isampler1D
isampler1DArray isampler2D isampler2DArray isampler2DMS isampler2DMSArray isampler2DRect isampler3D isamplerBuffer
isamplerCube isamplerCubeArray ivec2 ivec3 ivec4 layout long lowp mat2 mat2x2 mat2x3 mat2x4 mat3 mat3x2 mat3x3 mat3x4
mat4 mat4x2 mat4x3 mat4x4 mediump namespace noinline noperspective out output partition patch precise precision public
readonly resource restrict return sample sampler1D sampler1DArray sampler1DArrayShadow sampler1DShadow sampler2D
sampler2DArray sampler2DArrayShadow sampler2DMS sampler2DMSArray sampler2DRect sampler2DRectShadow sampler2DShadow
sampler3D sampler3DRect samplerBuffer samplerCube samplerCubeArray samplerCubeArrayShadow samplerCubeShadow shared
short sizeof smooth static struct subroutine superp switch template texture this true typedef uimage1D uimage1DArray
uimage2D uimage2DArray uimage2DMS uimage2DMSArray uimage2DRect uimage3D uimageBuffer uimageCube uimageCubeArray uint
uniform union unsigned usampler1D usampler1DArray usampler2D usampler2DArray usampler2DMS usampler2DMSArray
usampler2DRect usampler3D usamplerBuffer usamplerCube usamplerCubeArray using uvec2 uvec3 uvec4 varying vec2 vec3 vec4
void volatile while writeonly
"""

# Built-in functions: a variable of the same name would hide them. And the entry point.
_FUNCTIONS = """
abs acos acosh all any asin asinh atan atanh atomicAdd atomicAnd atomicCompSwap atomicCounter atomicExchange atomicMax
atomicMin atomicOr atomicXor barrier bitCount bitfieldExtract bitfieldInsert bitfieldReverse ceil clamp cos cosh cross
dFdx dFdxCoarse dFdxFine dFdy dFdyCoarse dFdyFine degrees determinant distance dot equal exp exp2 faceforward findLSB
findMSB floatBitsToInt floatBitsToUint floor fma fract frexp ftransform fwidth fwidthCoarse fwidthFine greaterThan
greaterThanEqual groupMemoryBarrier imageLoad imageSize imageStore imulExtended intBitsToFloat interpolateAtCentroid
interpolateAtOffset interpolateAtSample inverse inversesqrt isinf isnan ldexp length lessThan lessThanEqual log log2
main matrixCompMult max memoryBarrier min mix mod modf noise1 noise2 noise3 noise4 normalize not notEqual
outerProduct packHalf2x16 packSnorm2x16 packSnorm4x8 packUnorm2x16 packUnorm4x8 pow radians reflect refract round
roundEven shadow1D shadow2D sign sin sinh smoothstep sqrt step tan tanh texelFetch texelFetchOffset texture1D texture2D
texture2DProj texture3D textureCube textureGather textureGrad textureLod textureOffset textureProj
textureQueryLevels textureQueryLod textureSize transpose trunc uaddCarry uintBitsToFloat umulExtended unpackHalf2x16
unpackSnorm2x16 unpackSnorm4x8 unpackUnorm2x16 unpackUnorm4x8 usubBorrow
"""

# What our own templates and generated functions define (a test compares this list with the templates).
_TEMPLATES = """
BEYOND BOX_HIGH BOX_LOW Bracket CENTRE CUT EYE FAR Found GROW HALF_VIEW MANY_STEPS MOST_CONE_STEPS MOST_STEPS Nearest
Properties RADIUS State Surface TARGET TILE UP VERTICAL ambient axis_x axis_y axis_z ball blended blended_of both
box_distance box_distance_span box_interval bracket camera_ray chord chord_reach clearance cleared clip_from_scene
color_out cone depth_row direction_out distinct drawn encode_srgb enter entry evaluations events eye far_outside
far_point farther farther_of first_out gone gradient haste heat iMouse iResolution iTime inside leave light_at line_root
look look_up_tile mainImage map map_span march material meeting narrowed near_point nearer nearer_of nearest normal_out
occlusion_weight openness openness_map origin_out own own_tolerance painted_as parabola picture piece pixel
pixel_centre point_falloff position_out prepare properties radiance radiance_out ray_ahead ray_cone ray_origin rebase
reflect_light rounding scene_from_clip sdf shown sky sky_radiance slab_interval span_complement span_hull
span_intersection span_union span_within start_out start_state steps sun_disc sunk_parabola surface tangent tile_ray
tolerance tone_map trace trace_pixel trace_ray transmit travelled turned unfinished weight_row window within
within_steadily
"""

# Locals of templates and of generated statements: no function and no local of an expression may take these.
_LOCALS = """
o d p q t next near far eps fine first start limit count steps field light hit view normal toward
back before ahead sunk
"""
LOCALS = tuple(_LOCALS.split())

PARAM_PREFIX = "param_"
RESERVED = frozenset(_KEYWORDS.split()) | frozenset(_FUNCTIONS.split()) | frozenset(_TEMPLATES.split())


@lru_cache(maxsize=4096)
def identifier(name: str) -> str:
    """`name` if GLSL allows it as an identifier, else the nearest that it does: always the same one."""
    legal = re.sub(r"_{2,}", "_", re.sub(r"[^A-Za-z0-9_]", "_", name))
    if not legal.strip("_"):
        return "unnamed"
    if legal[0].isdigit() or legal.startswith("gl_"):
        return f"n{legal}"
    return f"{legal}_" if legal in RESERVED else legal


def param_name(name: str) -> str:
    """The global that holds a param: no variable or function of ours begins like it, so that none can hide it."""
    return identifier(f"{PARAM_PREFIX}{name}")


class Names:
    """The identifiers of one scope: gives out new ones."""

    def __init__(self, taken: Iterable[str] = ()) -> None:
        self._taken = set(taken)
        self._next: dict[str, int] = {}

    def reserve(self, name: str) -> None:
        """Keep `name` from being given out."""
        self._taken.add(name)

    def fresh(self, wanted: str) -> str:
        """`wanted` made legal; numbered from 2 if it is taken: q, q_2, q_3."""
        stem = name = identifier(wanted)
        number = self._next.get(stem, 2)
        while name in self._taken:
            name = f"{stem.rstrip('_')}_{number}"
            number += 1
        self._next[stem] = number
        self._taken.add(name)
        return name


@lru_cache(maxsize=4096)
def literal(x: float) -> str:
    """A number as a GLSL float: the shortest decimal that reads back as the same float32.

    A negative one begins with a minus, without brackets.
    """
    try:
        (rounded,) = struct.unpack("<f", struct.pack("<f", x))
    except OverflowError:
        rounded = math.inf
    if not math.isfinite(rounded):
        raise InternalError(f"{x} cannot be written as a GLSL number")
    if rounded == 0.0:
        return "0.0"
    # decimals of 6 digits are different float32s (but for the denormal ones), so the first that fits is the shortest
    fewest = 6 if abs(rounded) > 1.2e-38 else 1
    digits = next(text for text in (f"{rounded:.{n}g}" for n in range(fewest, 10)) if _float32(text) == rounded)
    if 1e-4 <= abs(rounded) < 1e9:
        return repr(float(digits))
    mantissa, _, exponent = digits.partition("e")
    return f"{mantissa}e{int(exponent)}" if exponent else repr(float(digits))


def _float32(text: str) -> float:
    """The float32 that a decimal reads as; infinity above the largest."""
    try:
        return float(struct.unpack("<f", struct.pack("<f", float(text)))[0])
    except OverflowError:
        return math.inf


def type_name(type_: Type) -> str:
    """The GLSL name of a field type."""
    return _TYPE_NAMES[type_]


_TYPE_NAMES = {Type.BOOL: "bool", Type.FLOAT: "float", Type.VEC2: "vec2", Type.VEC3: "vec3", Type.VEC4: "vec4"}
