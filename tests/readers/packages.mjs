// Packages from the folder that IVORY_NODE_MODULES names, wherever this file lies.
import { pathToFileURL } from 'node:url';
import { join } from 'node:path';

export const fromPackage = (path) => import(pathToFileURL(join(process.env.IVORY_NODE_MODULES, path)));
