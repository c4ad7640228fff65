// SPDX-License-Identifier: GPL-3.0-or-later
// Compiles a job as Flamenco's Manager does, with the objects that its documentation gives to job compiler scripts;
// prints the job type and the tasks as JSON. Arguments: the script; standard input: the job.
const fs = require("fs");
const vm = require("vm");

const author = {
    Task(name, type) {
        if (typeof name !== "string" || name.trim() === "") throw new Error("author.Task: name is required");
        if (typeof type !== "string" || type.trim() === "") throw new Error("author.Task: type is required");
        const task = { name: name, type: type, commands: [], dependencies: [] };
        // Not among what is printed
        Object.defineProperty(task, "addCommand", { value: (command) => task.commands.push(command) });
        Object.defineProperty(task, "addDependency", { value: (other) => task.dependencies.push(other.name) });
        return task;
    },
    Command(name, parameters) {
        return { name: name, parameters: parameters };
    },
};

const tasks = [];
const job = JSON.parse(fs.readFileSync(0, "utf8"));
// The Manager keeps a copy: what is added to a task later is lost
job.addTask = (task) => tasks.push(JSON.parse(JSON.stringify(task)));
job.created = new Date();

const context = vm.createContext({ author: author, print: () => {}, path: {}, process: {} });
const script = fs.readFileSync(process.argv[2], "utf8");
// The Manager compiles in strict mode, and takes both names from the script's globals
vm.runInContext(`"use strict";\n${script}\nthis.jobType = JOB_TYPE; this.compile = compileJob;`, context);
try {
    context.compile(job);
} catch (error) {
    console.error(String(error));
    process.exit(1);
}
console.log(JSON.stringify({ type: context.jobType, tasks: tasks }));
