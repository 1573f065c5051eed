// Patches with corners that have to look around for their normal: `fas.glsl` for those alone, since machines that run invocations abreast evaluate twice
// wherever one might. Twin of `method/fas.rs`.
#define NEARBY_NORMALS

#include "method/fas.glsl"
