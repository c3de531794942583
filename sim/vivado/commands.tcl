# Vivado's commands as far as build.tcl uses them, for tclsh: each looks whether the files that it is given are there, and is written down in
# the file COMMANDS. SLACK is the worst slack. Anything else is an unknown command, and an error.

set log [open $env(COMMANDS) w]

proc note {args} {
    global log
    puts $log $args
    flush $log
}

proc there {files} {
    foreach file $files {
        if {![file isfile $file]} { error "no such file: $file" }
    }
    if {[llength $files] == 0} { error "no files" }
}

foreach command {create_project set_property create_ip generate_target synth_ip opt_design place_design phys_opt_design route_design} {
    proc $command {args} "note $command {*}\$args"
}
proc current_project {} { return project }
proc get_ips {name} { return $name }
proc get_files {file} { there [list $file]; return $file }
foreach command {read_verilog read_mem read_xdc} {
    proc $command {files} "there \$files; note $command {*}\$files"
}
proc synth_design {args} { note synth_design {*}$args }
foreach command {report_utilization report_timing_summary report_cdc report_clock_interaction report_drc report_power write_checkpoint write_bitstream} {
    proc $command {args} "note $command {*}\$args; close \[open \[lindex \$args end\] w\]"
}
proc get_timing_paths {args} { note get_timing_paths {*}$args; return path }
proc get_property {name object} {
    global env
    if {$name ne "SLACK" || $object ne "path"} { error "get_property $name $object" }
    return $env(SLACK)
}

# The file of an option must be there, too.
rename set_property set_property_noted
proc set_property {args} {
    foreach argument $args {
        set at [lsearch $argument CONFIG.XML_INPUT_FILE]
        if {$at >= 0} { there [list [lindex $argument [expr {$at + 1}]]] }
    }
    set_property_noted {*}$args
}
