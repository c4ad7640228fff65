// SPDX-License-Identifier: GPL-3.0-or-later
// Flamenco's job type for a batch that `mimetic batch CLIPS --out DIR --submit flamenco` prepared: for each
// clip a task that captures it and, where something is baked, one that bakes, which depends on it.
// Goes into the folder `scripts` beside flamenco-manager.

const JOB_TYPE = {
    label: "Mimetic Batch",
    description: "Facial performance capture of many clips, and their bakes",
    settings: [
        {
            key: "batch",
            type: "string",
            subtype: "dir_path",
            required: true,
            visible: "submission",
            description: "The folder that mimetic batch prepared, on storage that all workers share",
        },
        {
            key: "clips",
            type: "string",
            required: true,
            visible: "web",
            eval: "'\\n'.join(sorted(path.parent.name for path in Path(settings.batch).glob('*/task.json')))",
            description: "Names of the clips' folders, a line each",
        },
        {
            key: "has_bakes",
            type: "bool",
            default: true,
            description: "Whether faces or characters are baked after the capture",
        },
        {
            key: "mimetic",
            type: "string",
            required: true,
            default: "mimetic",
            description: "The program mimetic, as workers find it",
        },
    ],
};

function compileJob(job) {
    const settings = job.settings;
    const clips = settings.clips.split("\n").filter((name) => name !== "");
    if (clips.length === 0) {
        throw "This batch has no clips: prepare it by mimetic batch CLIPS --out DIR --submit flamenco";
    }
    for (const clip of clips) {
        const capture = author.Task(`capture ${clip}`, "misc");
        capture.addCommand(runTask(settings, clip, ["--steps", "capture"]));
        job.addTask(capture);
        if (settings.has_bakes) {
            const bake = author.Task(`bake ${clip}`, "blender");
            bake.addCommand(runTask(settings, clip, []));
            bake.addDependency(capture);
            job.addTask(bake);
        }
    }
}

function runTask(settings, clip, steps) {
    const args = ["batch", `--task=${clip}`, "--out", settings.batch].concat(steps);
    return author.Command("exec", { exe: settings.mimetic, args: args });
}
