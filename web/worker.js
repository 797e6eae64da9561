// The worker of the page: it starts the same program, which finds no window here and fits.
import init from "./viewer.js";
await init();
