//! What a caller of the library did that cannot be drawn: refused, where it would otherwise tear a picture.

/// What a caller did that cannot be drawn. Nothing has been recorded or written when one of these is returned.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Misuse {
    /// The scratch ring is too small.
    #[error("the scratch ring is too small: a single patch needs {needed} bytes, it has {given}")]
    RingTooSmall {
        /// Bytes that the patch needs.
        needed: u64,
        /// Bytes that the ring has.
        given: u64,
    },
    /// A level that is no number, or beyond what the surface was made for.
    #[error("the level is {level}, and this surface is drawn at levels from 1 to {greatest}")]
    Level {
        /// What was asked for.
        level: f32,
        /// The greatest that can be drawn.
        greatest: f32,
    },
    /// The method's patches need the scratch ring, which the backend has not.
    #[error(
        "the method's patches need the scratch ring, which only control shaders fill, and the backend {backend} has none"
    )]
    BackendWithoutRing {
        /// The backend's name.
        backend: &'static str,
    },
    /// The backend does not go to such a level.
    #[error("the backend {backend} goes to level {greatest} only")]
    BackendLevel {
        /// The backend's name.
        backend: &'static str,
        /// The greatest level that it does.
        greatest: f32,
    },
    /// A level above 64 with fractional spacing, whose vertices lie where devices choose.
    #[error(
        "levels above 64 are drawn in pieces, which agree on their edges with equal spacing only"
    )]
    SubPatchSpacing,
    /// A level above 64 for patches that are triangles.
    #[error(
        "levels above 64 are drawn in pieces of quads, and the method has patches that are triangles"
    )]
    SubPatchesOfTriangles,
    /// A list whose patches may be cut into pieces, for pipelines that know nothing of them.
    #[error(
        "levels above 64 are drawn in pieces: make pipelines with PipelineOptions::sub_patches"
    )]
    SubPatchPipelines,
    /// What does not go with macro faces.
    #[error(
        "macro faces are drawn by the tessellator, at whole levels: that does not go together with {what}"
    )]
    MacroFaces {
        /// What was asked for as well.
        what: &'static str,
    },
    /// Macro faces at levels of which a side would have more segments than the tessellator makes.
    #[error(
        "macro faces of up to {span} faces a side are drawn at levels from 1 to {greatest}, since the tessellator makes 64 segments of a side at most"
    )]
    MacroLevel {
        /// The most faces of a side.
        span: u32,
        /// The greatest level.
        greatest: u32,
    },
    /// A surface that is never drawn.
    #[error("a surface is drawn in one round at least")]
    NoRounds,
    /// Vertices that are captured are counted by that.
    #[error("vertices are captured already; count them or capture them")]
    CountedAndCaptured,
    /// A round beyond those that the surface has counters for.
    #[error("round {round} (from 0) of a surface that was made for {rounds}")]
    Round {
        /// Which was asked for, from 0.
        round: u32,
        /// How many there are.
        rounds: u32,
    },
    /// More views than a frame may have, or one that `cmd_prepare` was not given.
    #[error("view {view} (from 0) of a frame that has {views}")]
    View {
        /// Which was asked for, from 0.
        view: u32,
        /// How many there are.
        views: u32,
    },
    /// Several views in one draw of a batch that uses the ring. There each view's control points are computed again, into slots of their own, so
    /// nothing is gained by it: a round a view, or a cache.
    #[error(
        "several views in one draw need their control points in a cache; in the ring each view has a round of its own"
    )]
    ViewsInRing,
    /// With multiview an instance has several views, and these are not some instances' views.
    #[error("{views} views for instances that have {eyes} each")]
    Eyes {
        /// How many views were asked for.
        views: u32,
        /// How many an instance has.
        eyes: u32,
    },
    /// Tangents of a method that has none.
    #[error(
        "patches of {shader} have no tangents: choose another method, or a fragment shader that asks for none"
    )]
    NoTangents {
        /// The file in `glsl/method` that evaluates them.
        shader: &'static str,
    },
    /// Multiview with a backend whose shaders know nothing of it.
    #[error("the backend {backend} draws one view at a time; the tessellator knows multiview")]
    MultiviewBackend {
        /// The backend's name.
        backend: &'static str,
    },
    /// A batch that waits for another inside dynamic rendering, which allows no barrier.
    #[error(
        "a batch waits for another, and dynamic rendering allows no barrier: switch off SurfaceOptions::barriers, or cache control points"
    )]
    BarrierInRendering,
    /// Sets of the engine's own for pipelines without a layout that has them.
    #[error("sets of the engine's own need pipelines with a layout of the engine's own")]
    OwnSets,
    /// Views and patches whose numbers do not go into the one that fragment shaders are told.
    #[error("views up to {views} of {patches} patches: the product has to be below 2^32")]
    ManyViews {
        /// The number behind the last view.
        views: u32,
        /// The number behind the last patch.
        patches: u32,
    },
    /// What was prepared is another mesh's.
    #[error("what was prepared is of another mesh: faces, tags or scheme differ")]
    OtherMesh,
    /// A draw list, pose or frame slot is another surface's.
    #[error(
        "a draw list, pose or frame slot was made for something else that was prepared, or for other options"
    )]
    OtherSurface,
    /// What only goes with decisions of the host.
    #[error("the device decides about patches: that does not go together with {what}")]
    DecidedByDevice {
        /// What was asked for as well.
        what: &'static str,
    },
    /// The device decides about patches, and has not yet for the views that are drawn, at this list's cut.
    #[error(
        "the device has not decided about all views that are drawn: cmd_decide comes behind cmd_prepare, with this draw list"
    )]
    NotDecided,
    /// Something that a decision goes by is not greater than 0.
    #[error("a decision goes by {given}, and has to go by something greater than 0")]
    Measure {
        /// What was given.
        given: f32,
    },
    /// Samples in standard places are in rows and columns of their own for 1, 2, 4 and 8 a pixel.
    #[error(
        "where {given} samples a pixel are is not known; decide without small patches, or with 1, 2, 4 or 8"
    )]
    Samples {
        /// How many there are to be.
        given: u32,
    },
    /// Levels go by one picture, and samples are in another.
    #[error("levels go by a picture of {levels:?} pixels, and samples are in one of {samples:?}")]
    Pictures {
        /// By which levels go.
        levels: [f32; 2],
        /// In which samples are.
        samples: [f32; 2],
    },
    /// The draw list needs what the host decides about patches, and another list's is on the device, or none.
    #[error("what the host decides about this draw list's patches was not written last")]
    NotWritten,
    /// A pose has no cache, or not the points of the level that is drawn, or not those of its positions.
    #[error(
        "the control points of this draw list were not cached: cmd_cache comes before it, with a pose that has a cache"
    )]
    NotCached,
    /// After an edit patches need more batches than the frame slot has counters for.
    #[error(
        "a draw list has {needed} batches that use the ring, in all rounds, and its frame slot counts {given}: make the slot anew, or with a larger ring"
    )]
    ManyBatches {
        /// How many there are.
        needed: u64,
        /// How many can be counted.
        given: u64,
    },
    /// The pipelines draw something else.
    #[error("the pipelines are for other passes, another backend, residence or spacing")]
    OtherPipelines,
    /// A list of one entry a control vertex has another length.
    #[error("{given} {what} for {expected} control vertices")]
    Count {
        /// What is listed.
        what: &'static str,
        /// How many came.
        given: usize,
        /// How many control vertices there are.
        expected: usize,
    },
    /// A plan was asked for of more than what a configuration tells of: of a face, say, of what surrounds a vertex.
    #[error("the configuration is that of {given} corners, and the plan is of {needed}")]
    Ring {
        /// Around how many corners of a face the plan goes.
        needed: u32,
        /// Around how many the configuration does.
        given: u32,
    },
    /// A plan with more control points than can be numbered. Only creases of sharpness 9 that are refined away come near.
    #[error("a plan has {points} control points, and {greatest} can be numbered")]
    PlanTooLarge {
        /// How many it has.
        points: usize,
        /// How many are possible.
        greatest: usize,
    },
    /// A triangle has a vertex that there is not.
    #[error("a triangle has vertex {vertex} (from 0) of {count}")]
    Index {
        /// The number that it has.
        vertex: u32,
        /// How many vertices there are.
        count: usize,
    },
    /// Bytes for a place in a buffer that the host does not see, or that is not there.
    #[error("{bytes} bytes at {offset} of a buffer of which the host sees {size}")]
    Outside {
        /// How many.
        bytes: usize,
        /// Where to.
        offset: u64,
        /// How many bytes of the buffer the host sees.
        size: usize,
    },
    /// A tag of the inside of a ptex face that is no depth.
    #[error("the depth of the inside of ptex face {ptex} is {depth}, and depths are from 0 to 10")]
    InsideDepth {
        /// The ptex face, from 0.
        ptex: usize,
        /// Its depth.
        depth: f32,
    },
    /// A depth tag that is no depth.
    #[error("the depth tag of control vertex {vertex} is {depth}, and depths are from 0 to 10")]
    Depth {
        /// The vertex, from 0.
        vertex: usize,
        /// Its tag.
        depth: f32,
    },
    /// A buffer that shaders cannot see as a whole.
    #[error(
        "{what}: {bytes} bytes, and shaders of this device see {limit} (maxStorageBufferRange)"
    )]
    BufferTooLarge {
        /// What it holds.
        what: String,
        /// Its size.
        bytes: u64,
        /// The device's limit.
        limit: u64,
    },
    /// Features that the device was created without.
    #[error("the device was created without {}", .lacking.join(", "))]
    Features {
        /// What is lacking, each in words.
        lacking: Vec<String>,
    },
    /// Nothing has been read back yet.
    #[error("nothing was read back: no cmd_read_back has been executed")]
    NotReadBack,
}
