// A sliver along a row of pixels, and a triangle below it that reaches out of the picture, in one draw: its fragments are told which side is seen, 1 for the front and 2 for the back,
// and then backs are culled. Fronts must be left.
//
//     cc culled_before_rounding.c -lvulkan && ./a.out
//
// Exit code 0: all is right; 1: the driver has the fault that culled_before_rounding.md beside this tells of; 2: it could not be tried.

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <vulkan/vulkan.h>

/* vertex shader:
#version 450
const vec2 corners[6] = vec2[](vec2(10.5, 10.490625), vec2(40.5, 10.51015625), vec2(25.5, 10.501171875), vec2(-9.0, 40.0), vec2(40.0, 40.0), vec2(40.0, 50.0));
void main() { gl_Position = vec4(corners[gl_VertexIndex] / 32.0 - 1.0, 0.5, 1.0); }
*/
static const uint32_t vertex[] = {
    0x7230203, 0x10000, 0x8000b, 0x37, 0x0, 0x20011, 0x1, 0x6000b, 0x1, 0x4c534c47, 0x6474732e,
    0x3035342e, 0x0, 0x3000e, 0x0, 0x1, 0x7000f, 0x0, 0x4, 0x6e69616d, 0x0, 0xd, 0x24, 0x30003,
    0x2, 0x1c2, 0x40005, 0x4, 0x6e69616d, 0x0, 0x60005, 0xb, 0x505f6c67, 0x65567265, 0x78657472,
    0x0, 0x60006, 0xb, 0x0, 0x505f6c67, 0x7469736f, 0x6e6f69, 0x70006, 0xb, 0x1, 0x505f6c67,
    0x746e696f, 0x657a6953, 0x0, 0x70006, 0xb, 0x2, 0x435f6c67, 0x4470696c, 0x61747369,
    0x65636e, 0x70006, 0xb, 0x3, 0x435f6c67, 0x446c6c75, 0x61747369, 0x65636e, 0x30005, 0xd,
    0x0, 0x60005, 0x24, 0x565f6c67, 0x65747265, 0x646e4978, 0x7865, 0x50005, 0x27, 0x65646e69,
    0x6c626178, 0x65, 0x50048, 0xb, 0x0, 0xb, 0x0, 0x50048, 0xb, 0x1, 0xb, 0x1, 0x50048, 0xb,
    0x2, 0xb, 0x3, 0x50048, 0xb, 0x3, 0xb, 0x4, 0x30047, 0xb, 0x2, 0x40047, 0x24, 0xb, 0x2a,
    0x20013, 0x2, 0x30021, 0x3, 0x2, 0x30016, 0x6, 0x20, 0x40017, 0x7, 0x6, 0x4, 0x40015, 0x8,
    0x20, 0x0, 0x4002b, 0x8, 0x9, 0x1, 0x4001c, 0xa, 0x6, 0x9, 0x6001e, 0xb, 0x7, 0x6, 0xa, 0xa,
    0x40020, 0xc, 0x3, 0xb, 0x4003b, 0xc, 0xd, 0x3, 0x40015, 0xe, 0x20, 0x1, 0x4002b, 0xe, 0xf,
    0x0, 0x40017, 0x10, 0x6, 0x2, 0x4002b, 0x8, 0x11, 0x6, 0x4001c, 0x12, 0x10, 0x11, 0x4002b,
    0x6, 0x13, 0x41280000, 0x4002b, 0x6, 0x14, 0x4127d99a, 0x5002c, 0x10, 0x15, 0x13, 0x14,
    0x4002b, 0x6, 0x16, 0x42220000, 0x4002b, 0x6, 0x17, 0x4128299a, 0x5002c, 0x10, 0x18, 0x16,
    0x17, 0x4002b, 0x6, 0x19, 0x41cc0000, 0x4002b, 0x6, 0x1a, 0x412804cd, 0x5002c, 0x10, 0x1b,
    0x19, 0x1a, 0x4002b, 0x6, 0x1c, 0xc1100000, 0x4002b, 0x6, 0x1d, 0x42200000, 0x5002c, 0x10,
    0x1e, 0x1c, 0x1d, 0x5002c, 0x10, 0x1f, 0x1d, 0x1d, 0x4002b, 0x6, 0x20, 0x42480000, 0x5002c,
    0x10, 0x21, 0x1d, 0x20, 0x9002c, 0x12, 0x22, 0x15, 0x18, 0x1b, 0x1e, 0x1f, 0x21, 0x40020,
    0x23, 0x1, 0xe, 0x4003b, 0x23, 0x24, 0x1, 0x40020, 0x26, 0x7, 0x12, 0x40020, 0x28, 0x7,
    0x10, 0x4002b, 0x6, 0x2b, 0x42000000, 0x4002b, 0x6, 0x2e, 0x3f800000, 0x4002b, 0x6, 0x31,
    0x3f000000, 0x40020, 0x35, 0x3, 0x7, 0x50036, 0x2, 0x4, 0x0, 0x3, 0x200f8, 0x5, 0x4003b,
    0x26, 0x27, 0x7, 0x4003d, 0xe, 0x25, 0x24, 0x3003e, 0x27, 0x22, 0x50041, 0x28, 0x29, 0x27,
    0x25, 0x4003d, 0x10, 0x2a, 0x29, 0x50050, 0x10, 0x2c, 0x2b, 0x2b, 0x50088, 0x10, 0x2d, 0x2a,
    0x2c, 0x50050, 0x10, 0x2f, 0x2e, 0x2e, 0x50083, 0x10, 0x30, 0x2d, 0x2f, 0x50051, 0x6, 0x32,
    0x30, 0x0, 0x50051, 0x6, 0x33, 0x30, 0x1, 0x70050, 0x7, 0x34, 0x32, 0x33, 0x31, 0x2e,
    0x50041, 0x35, 0x36, 0xd, 0xf, 0x3003e, 0x36, 0x34, 0x100fd, 0x10038,
};

/* fragment shader:
#version 450
layout(location = 0) out vec4 pixel;
void main() { pixel = vec4(gl_FrontFacing ? 1.0 : 2.0, 0.0, 0.0, 255.0) / 255.0; }
*/
static const uint32_t fragment[] = {
    0x7230203, 0x10000, 0x8000b, 0x16, 0x0, 0x20011, 0x1, 0x6000b, 0x1, 0x4c534c47, 0x6474732e,
    0x3035342e, 0x0, 0x3000e, 0x0, 0x1, 0x7000f, 0x4, 0x4, 0x6e69616d, 0x0, 0x9, 0xc, 0x30010,
    0x4, 0x7, 0x30003, 0x2, 0x1c2, 0x40005, 0x4, 0x6e69616d, 0x0, 0x40005, 0x9, 0x65786970,
    0x6c, 0x60005, 0xc, 0x465f6c67, 0x746e6f72, 0x69636146, 0x676e, 0x40047, 0x9, 0x1e, 0x0,
    0x40047, 0xc, 0xb, 0x11, 0x20013, 0x2, 0x30021, 0x3, 0x2, 0x30016, 0x6, 0x20, 0x40017, 0x7,
    0x6, 0x4, 0x40020, 0x8, 0x3, 0x7, 0x4003b, 0x8, 0x9, 0x3, 0x20014, 0xa, 0x40020, 0xb, 0x1,
    0xa, 0x4003b, 0xb, 0xc, 0x1, 0x4002b, 0x6, 0xe, 0x3f800000, 0x4002b, 0x6, 0xf, 0x40000000,
    0x4002b, 0x6, 0x11, 0x0, 0x4002b, 0x6, 0x12, 0x437f0000, 0x50036, 0x2, 0x4, 0x0, 0x3,
    0x200f8, 0x5, 0x4003d, 0xa, 0xd, 0xc, 0x600a9, 0x6, 0x10, 0xd, 0xe, 0xf, 0x70050, 0x7, 0x13,
    0x10, 0x11, 0x11, 0x12, 0x70050, 0x7, 0x14, 0x12, 0x12, 0x12, 0x12, 0x50088, 0x7, 0x15,
    0x13, 0x14, 0x3003e, 0x9, 0x15, 0x100fd, 0x10038,
};

enum { SIDE = 64, FRONT = 1, BACK = 2 };

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
    CHECK(vkCreateDevice(physical, &(VkDeviceCreateInfo){.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, .queueCreateInfoCount = 1,
        .pQueueCreateInfos = &queues}, NULL, &device));
    VkQueue queue;
    vkGetDeviceQueue(device, 0, 0, &queue);

    // A picture with a buffer that it is copied to.
    VkBuffer pixels_buffer;
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

    VkPipelineLayout layout;
    CHECK(vkCreatePipelineLayout(device, &(VkPipelineLayoutCreateInfo){.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO}, NULL,
        &layout));

    VkPipelineShaderStageCreateInfo stages[] = {
        stage(VK_SHADER_STAGE_VERTEX_BIT, vertex, sizeof vertex),
        stage(VK_SHADER_STAGE_FRAGMENT_BIT, fragment, sizeof fragment),
    };
    VkPipelineVertexInputStateCreateInfo input = {.sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
    VkPipelineInputAssemblyStateCreateInfo assembly = {.sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
        .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST};
    VkViewport viewport = {0, 0, SIDE, SIDE, 0, 1};
    VkRect2D area = {{0, 0}, {SIDE, SIDE}};
    VkPipelineViewportStateCreateInfo viewports = {.sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO, .viewportCount = 1,
        .pViewports = &viewport, .scissorCount = 1, .pScissors = &area};
    VkPipelineRasterizationStateCreateInfo raster = {.sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO,
        .rasterizerDiscardEnable = 0, .lineWidth = 1};
    VkPipelineMultisampleStateCreateInfo samples = {.sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO,
        .rasterizationSamples = 1};
    VkPipelineColorBlendAttachmentState mask = {.colorWriteMask = 15};
    VkPipelineColorBlendStateCreateInfo blend = {.sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO, .attachmentCount = 1,
        .pAttachments = &mask};
    VkCommandPool commands;
    CHECK(vkCreateCommandPool(device, &(VkCommandPoolCreateInfo){.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
        .flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT}, NULL, &commands));
    VkCommandBuffer cmd;
    CHECK(vkAllocateCommandBuffers(device, &(VkCommandBufferAllocateInfo){.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
        .commandPool = commands, .commandBufferCount = 1}, &cmd));
    // With both sides, and without backs.
    uint32_t pictures[2][SIDE * SIDE];
    for (int culls = 0; culls < 2; ++culls) {
        raster.cullMode = culls ? VK_CULL_MODE_BACK_BIT : VK_CULL_MODE_NONE;
        VkPipeline pipeline;
        CHECK(vkCreateGraphicsPipelines(device, VK_NULL_HANDLE, 1,
            &(VkGraphicsPipelineCreateInfo){.sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
            .stageCount = sizeof stages / sizeof *stages, .pStages = stages, .pVertexInputState = &input, .pInputAssemblyState = &assembly,
            .pViewportState = &viewports, .pRasterizationState = &raster, .pMultisampleState = &samples,
            .pColorBlendState = &blend, .layout = layout, .renderPass = pass}, NULL, &pipeline));
        CHECK(vkBeginCommandBuffer(cmd, &(VkCommandBufferBeginInfo){.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO}));
        VkClearValue black = {{{0}}};
        vkCmdBeginRenderPass(cmd, &(VkRenderPassBeginInfo){.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO, .renderPass = pass,
            .framebuffer = framebuffer, .renderArea = area, .clearValueCount = 1, .pClearValues = &black}, VK_SUBPASS_CONTENTS_INLINE);
        vkCmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline);
        vkCmdDraw(cmd, 6, 1, 0, 0);
        vkCmdEndRenderPass(cmd);
        vkCmdCopyImageToBuffer(cmd, image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, pixels_buffer, 1,
            &(VkBufferImageCopy){.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1}, .imageExtent = {SIDE, SIDE, 1}});
        VkMemoryBarrier to_host = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
            .srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT, .dstAccessMask = VK_ACCESS_HOST_READ_BIT};
        vkCmdPipelineBarrier(cmd, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0, 1, &to_host, 0, NULL, 0, NULL);
        CHECK(vkEndCommandBuffer(cmd));
        CHECK(vkQueueSubmit(queue, 1, &(VkSubmitInfo){.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO, .commandBufferCount = 1,
            .pCommandBuffers = &cmd}, VK_NULL_HANDLE));
        CHECK(vkQueueWaitIdle(queue));
        memcpy(pictures[culls], pixels, sizeof pictures[culls]);
    }

    int wrong = 0;
    for (uint32_t i = 0; i < SIDE * SIDE; ++i) {
        uint32_t side = pictures[0][i] & 255, left = pictures[1][i] & 255;
        if (left == (side == BACK ? 0 : side)) continue;
        if (!wrong++) printf("pixel %u,%u of the %s is %s\n", i % SIDE, i / SIDE, side == FRONT ? "front" : "back", left ? "left" : "culled");
    }
    if (wrong) printf("%d are wrong\n", wrong);
    else printf("all is right\n");
    return wrong != 0;
}
