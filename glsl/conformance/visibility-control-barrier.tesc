#version 460
#extension GL_GOOGLE_include_directive : require

// The Vulkan memory model, with everything in one control barrier.
#pragma use_vulkan_memory_model
#extension GL_KHR_memory_scope_semantics : require
#define CONTROL_MEMORY queuefamilycoherent
#define EVALUATION_MEMORY queuefamilycoherent
#define MAKE_VISIBLE
#define BARRIER controlBarrier(gl_ScopeWorkgroup, gl_ScopeQueueFamily, gl_StorageSemanticsBuffer | gl_StorageSemanticsOutput, gl_SemanticsAcquireRelease | gl_SemanticsMakeAvailable | gl_SemanticsMakeVisible)
#include "conformance/visibility_control.glsl"
