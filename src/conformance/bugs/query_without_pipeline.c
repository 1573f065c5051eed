// Push constants, and a query that begins before a pipeline is bound.
//
//     cc query_without_pipeline.c -lvulkan && ./a.out
//
// Exit code 0: all is right; 1: the driver has the fault that query_without_pipeline.md beside this tells of; 2: it could not be tried.

#define _DEFAULT_SOURCE
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vulkan/vulkan.h>

#define CHECK(call)                                            \
    do {                                                       \
        VkResult result = (call);                              \
        if (result != VK_SUCCESS) {                            \
            fprintf(stderr, "%s: %d\n", #call, (int)result);   \
            exit(2);                                           \
        }                                                      \
    } while (0)

// A query of pipeline statistics around nothing. The driver may end the process that does this.
static int count_nothing(void) {
    VkInstance instance;
    VkApplicationInfo application = {.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO, .apiVersion = VK_API_VERSION_1_1};
    CHECK(vkCreateInstance(&(VkInstanceCreateInfo){.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO, .pApplicationInfo = &application},
        NULL, &instance));
    uint32_t count = 1;
    VkPhysicalDevice physical;
    if (vkEnumeratePhysicalDevices(instance, &count, &physical) < 0 || count == 0) return fprintf(stderr, "no device\n"), 2;
    VkPhysicalDeviceProperties properties;
    vkGetPhysicalDeviceProperties(physical, &properties);
    printf("%s\n", properties.deviceName);
    fflush(stdout);

    float priority = 1.0f;
    VkDeviceQueueCreateInfo queues = {.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO, .queueFamilyIndex = 0, .queueCount = 1,
        .pQueuePriorities = &priority};
    VkPhysicalDeviceFeatures features = {.pipelineStatisticsQuery = 1};
    VkDevice device;
    CHECK(vkCreateDevice(physical, &(VkDeviceCreateInfo){.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, .queueCreateInfoCount = 1,
        .pQueueCreateInfos = &queues, .pEnabledFeatures = &features}, NULL, &device));
    VkQueue queue;
    vkGetDeviceQueue(device, 0, 0, &queue);

    VkPushConstantRange range = {VK_SHADER_STAGE_VERTEX_BIT, 0, 4};
    VkPipelineLayout layout;
    CHECK(vkCreatePipelineLayout(device, &(VkPipelineLayoutCreateInfo){.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
        .pushConstantRangeCount = 1, .pPushConstantRanges = &range}, NULL, &layout));
    VkQueryPool pool;
    CHECK(vkCreateQueryPool(device, &(VkQueryPoolCreateInfo){.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
        .queryType = VK_QUERY_TYPE_PIPELINE_STATISTICS, .queryCount = 1,
        .pipelineStatistics = VK_QUERY_PIPELINE_STATISTIC_VERTEX_SHADER_INVOCATIONS_BIT}, NULL, &pool));
    VkCommandPool commands;
    CHECK(vkCreateCommandPool(device, &(VkCommandPoolCreateInfo){.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO}, NULL, &commands));
    VkCommandBuffer cmd;
    CHECK(vkAllocateCommandBuffers(device, &(VkCommandBufferAllocateInfo){.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
        .commandPool = commands, .commandBufferCount = 1}, &cmd));
    CHECK(vkBeginCommandBuffer(cmd, &(VkCommandBufferBeginInfo){.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO}));
    vkCmdResetQueryPool(cmd, pool, 0, 1);
    vkCmdPushConstants(cmd, layout, VK_SHADER_STAGE_VERTEX_BIT, 0, 4, &(uint32_t){0});
    vkCmdBeginQuery(cmd, pool, 0, 0);
    vkCmdEndQuery(cmd, pool, 0);
    CHECK(vkEndCommandBuffer(cmd));
    CHECK(vkQueueSubmit(queue, 1, &(VkSubmitInfo){.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO, .commandBufferCount = 1,
        .pCommandBuffers = &cmd}, VK_NULL_HANDLE));
    CHECK(vkQueueWaitIdle(queue));
    uint64_t counted = 1;
    CHECK(vkGetQueryPoolResults(device, pool, 0, 1, sizeof counted, &counted, sizeof counted,
        VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT));
    if (counted != 0) return printf("%u invocations are counted of a draw that is not there\n", (unsigned)counted), 1;
    return 0;
}

int main(void) {
    pid_t child = fork();
    if (child < 0) return perror("fork"), 2;
    if (child == 0) {
        int code = count_nothing();
        fflush(stdout);
        _exit(code);
    }
    int status;
    if (waitpid(child, &status, 0) != child) return perror("waitpid"), 2;
    if (WIFSIGNALED(status)) return printf("the driver ends the process with signal %d\n", WTERMSIG(status)), 1;
    if (WEXITSTATUS(status) == 0) printf("all is right\n");
    return WEXITSTATUS(status);
}
