// The 4 invocations of a control shader leave a loop that is tested at its end at different times, and store what they read last in it.
//
//     cc loop_exits.c -lvulkan && ./a.out
//
// Exit code 0: all is right; 1: the driver has the fault that loop_exits.md beside this tells of; 2: it could not be tried.

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <vulkan/vulkan.h>

/* vertex shader:
#version 450
layout(location = 0) out uint number;
void main() {
    number = gl_VertexIndex;
    gl_Position = vec4(0.0, 0.0, 0.0, 1.0);
}
*/
static const uint32_t vertex[] = {
    0x7230203, 0x10000, 0xd000b, 0x1b, 0x0, 0x20011, 0x1, 0x6000b, 0x1, 0x4c534c47, 0x6474732e, 0x3035342e,
    0x0, 0x3000e, 0x0, 0x1, 0x8000f, 0x0, 0x4, 0x6e69616d, 0x0, 0x8, 0xb, 0x14,
    0x40047, 0x8, 0x1e, 0x0, 0x40047, 0xb, 0xb, 0x2a, 0x50048, 0x12, 0x0, 0xb,
    0x0, 0x50048, 0x12, 0x1, 0xb, 0x1, 0x50048, 0x12, 0x2, 0xb, 0x3, 0x50048,
    0x12, 0x3, 0xb, 0x4, 0x30047, 0x12, 0x2, 0x20013, 0x2, 0x30021, 0x3, 0x2,
    0x40015, 0x6, 0x20, 0x0, 0x40020, 0x7, 0x3, 0x6, 0x4003b, 0x7, 0x8, 0x3,
    0x40015, 0x9, 0x20, 0x1, 0x40020, 0xa, 0x1, 0x9, 0x4003b, 0xa, 0xb, 0x1,
    0x30016, 0xe, 0x20, 0x40017, 0xf, 0xe, 0x4, 0x4002b, 0x6, 0x10, 0x1, 0x4001c,
    0x11, 0xe, 0x10, 0x6001e, 0x12, 0xf, 0xe, 0x11, 0x11, 0x40020, 0x13, 0x3,
    0x12, 0x4003b, 0x13, 0x14, 0x3, 0x4002b, 0x9, 0x15, 0x0, 0x4002b, 0xe, 0x16,
    0x0, 0x4002b, 0xe, 0x17, 0x3f800000, 0x7002c, 0xf, 0x18, 0x16, 0x16, 0x16, 0x17,
    0x40020, 0x19, 0x3, 0xf, 0x50036, 0x2, 0x4, 0x0, 0x3, 0x200f8, 0x5, 0x4003d,
    0x9, 0xc, 0xb, 0x4007c, 0x6, 0xd, 0xc, 0x3003e, 0x8, 0xd, 0x50041, 0x19,
    0x1a, 0x14, 0x15, 0x3003e, 0x1a, 0x18, 0x100fd, 0x10038,
};

/* control shader:
#version 450
layout(vertices = 4) out;
layout(location = 0) in uint vertex_number[];
layout(set = 0, binding = 0) buffer Words { uint words[]; };
void main() {
    uint i = 0u, last;
    do {
        last = words[i];
        ++i;
    } while (i <= uint(gl_InvocationID));
    words[8 + gl_InvocationID] = last;
    for (int i = 0; i < 4; ++i) gl_TessLevelOuter[i] = 1.0;
    for (int i = 0; i < 2; ++i) gl_TessLevelInner[i] = 1.0;
}
*/
static const uint32_t control[] = {
    0x7230203, 0x10000, 0xd000b, 0x55, 0x0, 0x20011, 0x3, 0x6000b, 0x1, 0x4c534c47, 0x6474732e, 0x3035342e, 0x0,
    0x3000e, 0x0, 0x1, 0x8000f, 0x1, 0x4, 0x6e69616d, 0x0, 0x1e, 0x36, 0x49, 0x40010, 0x4, 0x1a, 0x4, 0x40047,
    0xf, 0x6, 0x4, 0x50048, 0x10, 0x0, 0x23, 0x0, 0x30047, 0x10, 0x3, 0x40047, 0x12, 0x22, 0x0, 0x40047, 0x12,
    0x21, 0x0, 0x40047, 0x1e, 0xb, 0x8, 0x30047, 0x36, 0xf, 0x40047, 0x36, 0xb, 0xb, 0x30047, 0x49, 0xf,
    0x40047, 0x49, 0xb, 0xc, 0x20013, 0x2, 0x30021, 0x3, 0x2, 0x40015, 0x6, 0x20, 0x0, 0x4002b, 0x6, 0x9, 0x0,
    0x3001d, 0xf, 0x6, 0x3001e, 0x10, 0xf, 0x40020, 0x11, 0x2, 0x10, 0x4003b, 0x11, 0x12, 0x2, 0x40015, 0x13,
    0x20, 0x1, 0x4002b, 0x13, 0x14, 0x0, 0x40020, 0x16, 0x2, 0x6, 0x4002b, 0x13, 0x1a, 0x1, 0x40020, 0x1d, 0x1,
    0x13, 0x4003b, 0x1d, 0x1e, 0x1, 0x20014, 0x21, 0x4002b, 0x13, 0x23, 0x8, 0x4002b, 0x13, 0x30, 0x4, 0x30016,
    0x32, 0x20, 0x4002b, 0x6, 0x33, 0x4, 0x4001c, 0x34, 0x32, 0x33, 0x40020, 0x35, 0x3, 0x34, 0x4003b, 0x35,
    0x36, 0x3, 0x4002b, 0x32, 0x38, 0x3f800000, 0x40020, 0x39, 0x3, 0x32, 0x4002b, 0x13, 0x44, 0x2, 0x4002b,
    0x6, 0x46, 0x2, 0x4001c, 0x47, 0x32, 0x46, 0x40020, 0x48, 0x3, 0x47, 0x4003b, 0x48, 0x49, 0x3, 0x50036, 0x2,
    0x4, 0x0, 0x3, 0x200f8, 0x5, 0x200f9, 0xa, 0x200f8, 0xa, 0x700f5, 0x6, 0x52, 0x9, 0x5, 0x1b, 0xa, 0x60041,
    0x16, 0x17, 0x12, 0x14, 0x52, 0x4003d, 0x6, 0x18, 0x17, 0x50080, 0x6, 0x1b, 0x52, 0x1a, 0x4003d, 0x13, 0x1f,
    0x1e, 0x4007c, 0x6, 0x20, 0x1f, 0x500b2, 0x21, 0x22, 0x1b, 0x20, 0x400f6, 0xc, 0xa, 0x0, 0x400fa, 0x22, 0xa,
    0xc, 0x200f8, 0xc, 0x50080, 0x13, 0x25, 0x23, 0x1f, 0x60041, 0x16, 0x27, 0x12, 0x14, 0x25, 0x3003e, 0x27,
    0x18, 0x200f9, 0x2a, 0x200f8, 0x2a, 0x700f5, 0x13, 0x53, 0x14, 0xc, 0x3c, 0x2b, 0x500b1, 0x21, 0x31, 0x53,
    0x30, 0x400f6, 0x2c, 0x2b, 0x0, 0x400fa, 0x31, 0x2b, 0x2c, 0x200f8, 0x2b, 0x50041, 0x39, 0x3a, 0x36, 0x53,
    0x3003e, 0x3a, 0x38, 0x50080, 0x13, 0x3c, 0x53, 0x1a, 0x200f9, 0x2a, 0x200f8, 0x2c, 0x200f9, 0x3e, 0x200f8,
    0x3e, 0x700f5, 0x13, 0x54, 0x14, 0x2c, 0x4d, 0x3f, 0x500b1, 0x21, 0x45, 0x54, 0x44, 0x400f6, 0x40, 0x3f,
    0x0, 0x400fa, 0x45, 0x3f, 0x40, 0x200f8, 0x3f, 0x50041, 0x39, 0x4b, 0x49, 0x54, 0x3003e, 0x4b, 0x38,
    0x50080, 0x13, 0x4d, 0x54, 0x1a, 0x200f9, 0x3e, 0x200f8, 0x40, 0x100fd, 0x10038,
};

/* evaluation shader:
#version 450
layout(quads, equal_spacing, ccw) in;
void main() {
    gl_Position = vec4(gl_TessCoord, 1.0);
}
*/
static const uint32_t evaluation[] = {
    0x7230203, 0x10000, 0xd000b, 0x1b, 0x0, 0x20011, 0x3, 0x6000b, 0x1, 0x4c534c47, 0x6474732e, 0x3035342e, 0x0,
    0x3000e, 0x0, 0x1, 0x7000f, 0x2, 0x4, 0x6e69616d, 0x0, 0xd, 0x12, 0x30010, 0x4, 0x18, 0x30010, 0x4, 0x1,
    0x30010, 0x4, 0x5, 0x50048, 0xb, 0x0, 0xb, 0x0, 0x50048, 0xb, 0x1, 0xb, 0x1, 0x50048, 0xb, 0x2, 0xb, 0x3,
    0x50048, 0xb, 0x3, 0xb, 0x4, 0x30047, 0xb, 0x2, 0x40047, 0x12, 0xb, 0xd, 0x20013, 0x2, 0x30021, 0x3, 0x2,
    0x30016, 0x6, 0x20, 0x40017, 0x7, 0x6, 0x4, 0x40015, 0x8, 0x20, 0x0, 0x4002b, 0x8, 0x9, 0x1, 0x4001c, 0xa,
    0x6, 0x9, 0x6001e, 0xb, 0x7, 0x6, 0xa, 0xa, 0x40020, 0xc, 0x3, 0xb, 0x4003b, 0xc, 0xd, 0x3, 0x40015, 0xe,
    0x20, 0x1, 0x4002b, 0xe, 0xf, 0x0, 0x40017, 0x10, 0x6, 0x3, 0x40020, 0x11, 0x1, 0x10, 0x4003b, 0x11, 0x12,
    0x1, 0x4002b, 0x6, 0x14, 0x3f800000, 0x40020, 0x19, 0x3, 0x7, 0x50036, 0x2, 0x4, 0x0, 0x3, 0x200f8, 0x5,
    0x4003d, 0x10, 0x13, 0x12, 0x50051, 0x6, 0x15, 0x13, 0x0, 0x50051, 0x6, 0x16, 0x13, 0x1, 0x50051, 0x6, 0x17,
    0x13, 0x2, 0x70050, 0x7, 0x18, 0x15, 0x16, 0x17, 0x14, 0x50041, 0x19, 0x1a, 0xd, 0xf, 0x3003e, 0x1a, 0x18,
    0x100fd, 0x10038,
};

enum { PATCHES = 1 };
enum { SIDE = 64, WORDS = 65536 };

#define CHECK(call)                                            \
    do {                                                       \
        VkResult result = (call);                              \
        if (result != VK_SUCCESS) {                            \
            fprintf(stderr, "%s: %d\n", #call, (int)result);   \
            exit(2);                                           \
        }                                                      \
    } while (0)

static VkPhysicalDevice physical;
static VkDevice device;

// Memory that the host sees, bound and mapped.
static uint32_t *map_buffer(VkDeviceSize size, VkBufferUsageFlags usage, VkBuffer *buffer) {
    CHECK(vkCreateBuffer(device, &(VkBufferCreateInfo){.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = size, .usage = usage},
        NULL, buffer));
    VkMemoryRequirements needs;
    vkGetBufferMemoryRequirements(device, *buffer, &needs);
    VkPhysicalDeviceMemoryProperties memory;
    vkGetPhysicalDeviceMemoryProperties(physical, &memory);
    VkMemoryPropertyFlags wanted = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    uint32_t type = 0;
    while (!(needs.memoryTypeBits >> type & 1) || (memory.memoryTypes[type].propertyFlags & wanted) != wanted) ++type;
    VkDeviceMemory block;
    CHECK(vkAllocateMemory(device, &(VkMemoryAllocateInfo){.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, .allocationSize = needs.size,
        .memoryTypeIndex = type}, NULL, &block));
    CHECK(vkBindBufferMemory(device, *buffer, block, 0));
    void *mapped;
    CHECK(vkMapMemory(device, block, 0, VK_WHOLE_SIZE, 0, &mapped));
    memset(mapped, 0, size);
    return mapped;
}

static VkPipelineShaderStageCreateInfo stage(VkShaderStageFlagBits bit, const uint32_t *words, size_t size) {
    VkShaderModule module;
    CHECK(vkCreateShaderModule(device, &(VkShaderModuleCreateInfo){.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
        .codeSize = size, .pCode = words}, NULL, &module));
    return (VkPipelineShaderStageCreateInfo){.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO, .stage = bit,
        .module = module, .pName = "main"};
}

int main(void) {
    VkInstance instance;
    VkApplicationInfo application = {.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO, .apiVersion = VK_API_VERSION_1_1};
    CHECK(vkCreateInstance(&(VkInstanceCreateInfo){.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO, .pApplicationInfo = &application},
        NULL, &instance));
    uint32_t count = 1;
    if (vkEnumeratePhysicalDevices(instance, &count, &physical) < 0 || count == 0) return fprintf(stderr, "no device\n"), 2;
    VkPhysicalDeviceProperties properties;
    vkGetPhysicalDeviceProperties(physical, &properties);
    printf("%s\n", properties.deviceName);

    float priority = 1.0f;
    VkDeviceQueueCreateInfo queues = {.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO, .queueFamilyIndex = 0, .queueCount = 1,
        .pQueuePriorities = &priority};
    VkPhysicalDeviceFeatures features = {.tessellationShader = 1, .vertexPipelineStoresAndAtomics = 1, .geometryShader = 1};
    CHECK(vkCreateDevice(physical, &(VkDeviceCreateInfo){.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, .queueCreateInfoCount = 1,
        .pQueueCreateInfos = &queues, .pEnabledFeatures = &features}, NULL, &device));
    VkQueue queue;
    vkGetDeviceQueue(device, 0, 0, &queue);

    // A buffer that shaders write, and a picture with a buffer that it is copied to.
    VkBuffer words_buffer, pixels_buffer;
    uint32_t *words = map_buffer(4 * WORDS, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, &words_buffer);
    uint32_t *pixels = map_buffer(4 * SIDE * SIDE, VK_BUFFER_USAGE_TRANSFER_DST_BIT, &pixels_buffer);
    VkImage image;
    CHECK(vkCreateImage(device, &(VkImageCreateInfo){.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO, .imageType = VK_IMAGE_TYPE_2D,
        .format = VK_FORMAT_R8G8B8A8_UNORM, .extent = {SIDE, SIDE, 1}, .mipLevels = 1, .arrayLayers = 1, .samples = 1,
        .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT}, NULL, &image));
    VkMemoryRequirements needs;
    vkGetImageMemoryRequirements(device, image, &needs);
    uint32_t type = 0;
    while (!(needs.memoryTypeBits >> type & 1)) ++type;
    VkDeviceMemory image_memory;
    CHECK(vkAllocateMemory(device, &(VkMemoryAllocateInfo){.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, .allocationSize = needs.size,
        .memoryTypeIndex = type}, NULL, &image_memory));
    CHECK(vkBindImageMemory(device, image, image_memory, 0));
    VkImageView view;
    VkImageSubresourceRange colour = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    CHECK(vkCreateImageView(device, &(VkImageViewCreateInfo){.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO, .image = image,
        .viewType = VK_IMAGE_VIEW_TYPE_2D, .format = VK_FORMAT_R8G8B8A8_UNORM, .subresourceRange = colour}, NULL, &view));

    VkAttachmentDescription attachment = {.format = VK_FORMAT_R8G8B8A8_UNORM, .samples = 1, .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR,
        .storeOp = VK_ATTACHMENT_STORE_OP_STORE, .stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE,
        .stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE, .finalLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL};
    VkAttachmentReference reference = {0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
    VkSubpassDescription subpass = {.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS, .colorAttachmentCount = 1,
        .pColorAttachments = &reference};
    VkSubpassDependency after = {.srcSubpass = 0, .dstSubpass = VK_SUBPASS_EXTERNAL,
        .srcStageMask = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT, .dstStageMask = VK_PIPELINE_STAGE_TRANSFER_BIT,
        .srcAccessMask = VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT, .dstAccessMask = VK_ACCESS_TRANSFER_READ_BIT};
    VkRenderPass pass;
    CHECK(vkCreateRenderPass(device, &(VkRenderPassCreateInfo){.sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO, .attachmentCount = 1,
        .pAttachments = &attachment, .subpassCount = 1, .pSubpasses = &subpass, .dependencyCount = 1, .pDependencies = &after}, NULL,
        &pass));
    VkFramebuffer framebuffer;
    CHECK(vkCreateFramebuffer(device, &(VkFramebufferCreateInfo){.sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO, .renderPass = pass,
        .attachmentCount = 1, .pAttachments = &view, .width = SIDE, .height = SIDE, .layers = 1}, NULL, &framebuffer));

    VkDescriptorSetLayoutBinding binding = {.descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, .descriptorCount = 1,
        .stageFlags = VK_SHADER_STAGE_TESSELLATION_CONTROL_BIT};
    VkDescriptorSetLayout set_layout;
    CHECK(vkCreateDescriptorSetLayout(device,
        &(VkDescriptorSetLayoutCreateInfo){.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO, .bindingCount = 1,
        .pBindings = &binding}, NULL, &set_layout));
    VkPipelineLayout layout;
    CHECK(vkCreatePipelineLayout(device, &(VkPipelineLayoutCreateInfo){.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
        .setLayoutCount = 1, .pSetLayouts = &set_layout}, NULL, &layout));
    VkDescriptorPoolSize size = {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1};
    VkDescriptorPool pool;
    CHECK(vkCreateDescriptorPool(device, &(VkDescriptorPoolCreateInfo){.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
        .maxSets = 1, .poolSizeCount = 1, .pPoolSizes = &size}, NULL, &pool));
    VkDescriptorSet set;
    CHECK(vkAllocateDescriptorSets(device, &(VkDescriptorSetAllocateInfo){.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
        .descriptorPool = pool, .descriptorSetCount = 1, .pSetLayouts = &set_layout}, &set));
    VkDescriptorBufferInfo whole = {words_buffer, 0, VK_WHOLE_SIZE};
    vkUpdateDescriptorSets(device, 1, &(VkWriteDescriptorSet){.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET, .dstSet = set,
        .descriptorCount = 1, .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, .pBufferInfo = &whole}, 0, NULL);

    VkPipelineShaderStageCreateInfo stages[] = {
        stage(VK_SHADER_STAGE_VERTEX_BIT, vertex, sizeof vertex),
        stage(VK_SHADER_STAGE_TESSELLATION_CONTROL_BIT, control, sizeof control),
        stage(VK_SHADER_STAGE_TESSELLATION_EVALUATION_BIT, evaluation, sizeof evaluation),
    };
    VkPipelineVertexInputStateCreateInfo input = {.sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
    VkPipelineInputAssemblyStateCreateInfo assembly = {.sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
        .topology = VK_PRIMITIVE_TOPOLOGY_PATCH_LIST};
    VkPipelineTessellationStateCreateInfo tessellation = {.sType = VK_STRUCTURE_TYPE_PIPELINE_TESSELLATION_STATE_CREATE_INFO,
        .patchControlPoints = 1};
    VkViewport viewport = {0, 0, SIDE, SIDE, 0, 1};
    VkRect2D area = {{0, 0}, {SIDE, SIDE}};
    VkPipelineViewportStateCreateInfo viewports = {.sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO, .viewportCount = 1,
        .pViewports = &viewport, .scissorCount = 1, .pScissors = &area};
    VkPipelineRasterizationStateCreateInfo raster = {.sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO,
        .rasterizerDiscardEnable = 1, .lineWidth = 1};
    VkPipelineMultisampleStateCreateInfo samples = {.sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO,
        .rasterizationSamples = 1};
    VkPipelineColorBlendAttachmentState mask = {.colorWriteMask = 15};
    VkPipelineColorBlendStateCreateInfo blend = {.sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO, .attachmentCount = 1,
        .pAttachments = &mask};
    VkPipeline pipeline;
    CHECK(vkCreateGraphicsPipelines(device, VK_NULL_HANDLE, 1,
        &(VkGraphicsPipelineCreateInfo){.sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
        .stageCount = sizeof stages / sizeof *stages, .pStages = stages, .pVertexInputState = &input, .pInputAssemblyState = &assembly,
        .pTessellationState = &tessellation, .pViewportState = &viewports, .pRasterizationState = &raster, .pMultisampleState = &samples,
        .pColorBlendState = &blend, .layout = layout, .renderPass = pass}, NULL, &pipeline));

    for (uint32_t i = 0; i < 4; ++i) words[i] = i + 10;
    VkCommandPool commands;
    CHECK(vkCreateCommandPool(device, &(VkCommandPoolCreateInfo){.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO}, NULL, &commands));
    VkCommandBuffer cmd;
    CHECK(vkAllocateCommandBuffers(device, &(VkCommandBufferAllocateInfo){.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
        .commandPool = commands, .commandBufferCount = 1}, &cmd));
    CHECK(vkBeginCommandBuffer(cmd, &(VkCommandBufferBeginInfo){.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO}));
    VkClearValue black = {{{0}}};
    vkCmdBeginRenderPass(cmd, &(VkRenderPassBeginInfo){.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO, .renderPass = pass,
        .framebuffer = framebuffer, .renderArea = area, .clearValueCount = 1, .pClearValues = &black}, VK_SUBPASS_CONTENTS_INLINE);
    vkCmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline);
    vkCmdBindDescriptorSets(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, layout, 0, 1, &set, 0, NULL);
    vkCmdDraw(cmd, PATCHES, 1, 0, 0);
    vkCmdEndRenderPass(cmd);
    vkCmdCopyImageToBuffer(cmd, image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, pixels_buffer, 1,
        &(VkBufferImageCopy){.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1}, .imageExtent = {SIDE, SIDE, 1}});
    VkMemoryBarrier to_host = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
        .srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_WRITE_BIT, .dstAccessMask = VK_ACCESS_HOST_READ_BIT};
    vkCmdPipelineBarrier(cmd, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0, 1, &to_host, 0, NULL, 0, NULL);
    CHECK(vkEndCommandBuffer(cmd));
    CHECK(vkQueueSubmit(queue, 1, &(VkSubmitInfo){.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO, .commandBufferCount = 1,
        .pCommandBuffers = &cmd}, VK_NULL_HANDLE));
    CHECK(vkQueueWaitIdle(queue));

    int wrong = 0;
    for (uint32_t i = 0; i < 4; ++i) {
        if (words[8 + i] == i + 10) continue;
        if (!wrong++) printf("invocation %u has %u instead of %u\n", i, words[8 + i], i + 10);
    }
    (void)words, (void)pixels;
    if (wrong) printf("%d are wrong\n", wrong);
    else printf("all is right\n");
    return wrong != 0;
}
