"""From a `Cable` to an FMU archive: variable table, resource file, model description, zip."""
