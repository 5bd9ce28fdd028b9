/* Of the library and of the Python package that it comes with [models/cablefmu/__init__.py]. */
#ifndef CABLE_VERSION_H
#define CABLE_VERSION_H

#define CABLE_VERSION "0.1.0"

#endif
